#version 430 core
// Any-hit shadow rays through trees of boxes: scene/box_tree.h. Stands before the programs that trace.
layout(std430, binding = 0) readonly buffer Nodes { uvec4 nodes[]; };          // a node: two; of all trees, places counted through
layout(std430, binding = 1) readonly buffer Triangles { vec4 triangles[]; };   // a triangle: a corner and two edges

bool hitsTriangle(uint t, vec3 origin, vec3 direction, float far) {
    vec3 e1 = triangles[3u * t + 1u].xyz, e2 = triangles[3u * t + 2u].xyz, p = cross(direction, e2);
    float determinant = dot(e1, p);
    if (determinant == 0) return false;
    float inverse = 1 / determinant;
    vec3 s = origin - triangles[3u * t].xyz;
    float u = dot(s, p) * inverse;
    vec3 q = cross(s, e1);
    float v = dot(direction, q) * inverse, at = dot(e2, q) * inverse;
    return u >= -1e-6 && v >= -1e-6 && u + v <= 1.000001 && at >= 0 && at <= far;
}

// Whether a triangle of the tree [at, end) lies on the ray. The direction need not be of unit length.
bool blocked(uint at, uint end, vec3 origin, vec3 direction, float far) {
    vec3 safe = mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
    vec3 inverse = 1 / safe;
    while (at < end) {
        uvec4 low = nodes[2u * at], high = nodes[2u * at + 1u];
        vec3 a = (uintBitsToFloat(low.xyz) - origin) * inverse, b = (uintBitsToFloat(high.xyz) - origin) * inverse;
        vec3 first = min(a, b), last = max(a, b);
        float enter = max(max(first.x, first.y), max(first.z, 0.0)), leave = min(min(last.x, last.y), min(last.z, far));
        if (enter > leave * 1.000001) {
            at = low.w;
            continue;
        }
        for (uint t = high.w >> 3u; t < (high.w >> 3u) + (high.w & 7u); ++t)
            if (hitsTriangle(t, origin, direction, far)) return true;
        ++at;
    }
    return false;
}
