#version 430 core
// Light that each vertex takes from the environment: TransportStore::apply(). A lane is a vertex; sixteen of them share a list of terms.
// The terms are added in the order of the list, so that the same light gives the same bits.
layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Index { uint indexPairs[]; };     // a term: two to a word
layout(std430, binding = 1) readonly buffer Value { uint valuePairs[]; };     // a term: sixteen signed values, two to a word
layout(std430, binding = 2) readonly buffer Start { uint start[]; };          // a block: its first term
layout(std430, binding = 3) readonly buffer Scale { float scale[]; };         // a vertex
layout(std430, binding = 4) readonly buffer Coefs { vec4 coefs[]; };          // of the environment
layout(std430, binding = 5) writeonly buffer Light { float light[]; };        // a vertex: three channels

uniform uint blocks;

void main() {
    uint vertex = gl_GlobalInvocationID.x;
    uint block = vertex / 16u, lane = vertex % 16u;
    if (block >= blocks) return;
    int shift = int(lane & 1u) * 16;
    uint end = start[block + 1u];
    vec3 sum = vec3(0);
    for (uint t = start[block]; t < end; ++t) {
        uint i = indexPairs[t >> 1u] >> ((t & 1u) * 16u) & 0xffffu;
        int pair = int(valuePairs[t * 8u + (lane >> 1u)]);
        sum += float(bitfieldExtract(pair, shift, 16)) * coefs[i].rgb;
    }
    sum *= scale[vertex];
    light[vertex * 3u] = sum.r;
    light[vertex * 3u + 1u] = sum.g;
    light[vertex * 3u + 2u] = sum.b;
}
