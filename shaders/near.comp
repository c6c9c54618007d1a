// Form factor of one emitter at each wanted vertex, with shadows: nearFactor() of relight/live/near.cpp with the same
// samples, and LiveEmitterTree::cut(). A lane is a vertex. It walks the emitter's tree twice: once for the sum, once to
// take the samples as the running sum passes them. Nothing is added across lanes: the same bits every time.
layout(local_size_x = 64) in;

layout(std430, binding = 2) readonly buffer Positions { float positions[]; };  // a vertex: three
layout(std430, binding = 3) readonly buffer Normals { float normals[]; };
layout(std430, binding = 4) readonly buffer Wanted { uint wanted[]; };
layout(std430, binding = 5) readonly buffer Emitter { vec4 emitter[]; };       // nodes of four, then triangles of four
layout(std430, binding = 6) readonly buffer Parts { vec4 parts[]; };           // a part: three rows of part from world, sphere, tree
layout(std430, binding = 7) buffer Answers { vec2 answers[]; };                // factor, unshadowed; between two runs weights: seen, all

uniform uint count, emitterNodes, partCount, groundEnd, samples, splits, skipped;  // skipped: the part that hides nothing
uniform uint from, to;                                                           // samples of this run
uniform uvec2 seed;                                                              // upper, lower half
uniform vec4 sphere;                                                            // the emitter's
uniform vec3 tolerance;                                                         // far, cone's cosine, above
uniform bool twoSided, shadows, mayDouble;
uniform float offset;

const float pi = 3.14159265358979;

// 64 bits in two halves, upper first.
uvec2 times(uvec2 a, uvec2 b) {
    uint high, low;
    umulExtended(a.y, b.y, high, low);
    return uvec2(high + a.x * b.y + a.y * b.x, low);
}
uvec2 shifted(uvec2 a, int by) { return uvec2(a.x >> by, a.y >> by | a.x << (32 - by)); }
uvec2 mixBits(uvec2 x) {
    uint carry;
    uint low = uaddCarry(x.y, 0x7f4a7c15u, carry);
    x = uvec2(x.x + 0x9e3779b9u + carry, low);
    x = times(x ^ shifted(x, 30), uvec2(0xbf58476du, 0x1ce4e5b9u));
    x = times(x ^ shifted(x, 27), uvec2(0x94d049bbu, 0x133111ebu));
    return x ^ shifted(x, 31);
}
float unitFloat(uint bits24) { return float(bits24) * (1.0 / 16777216.0); }

vec3 point, normal, origin;
uint between;          // parts that can stand between, the first 32
uint taken, last, most;  // samples
uvec2 shift;           // of the pattern, 32 bits of fraction
float first, scale, running, everything, allWeight, seen;

bool occluded(vec3 direction, float far) {
    if (blocked(0u, groundEnd, origin, direction, far)) return true;
    for (uint b = 0u; b < partCount; ++b) {
        if (b < 32u && (between >> b & 1u) == 0u) continue;
        if (b == skipped) continue;
        vec4 ball = parts[5u * b + 3u];
        vec3 to = ball.xyz - origin;
        float along = dot(to, direction), d2 = dot(to, to), r2 = ball.w * ball.w;
        if (d2 >= r2 && !(along > 0 && along - ball.w < far && d2 - along * along < r2)) continue;
        vec4 x = parts[5u * b], y = parts[5u * b + 1u], z = parts[5u * b + 2u];
        vec4 place = vec4(origin, 1);
        uvec4 tree = floatBitsToUint(parts[5u * b + 4u]);
        if (blocked(tree.x, tree.y, vec3(dot(x, place), dot(y, place), dot(z, place)),
                    vec3(dot(x.xyz, direction), dot(y.xyz, direction), dot(z.xyz, direction)), far))
            return true;
    }
    return false;
}

uint triangleAt(uint place) { return 4u * (emitterNodes + place); }

// The samples that fall on a component. begin == end: on the triangle `c`.
void take(uint begin, uint end, vec3 c[3], float area, float factor) {
    running += factor * scale;
    for (; taken < last && (float(taken) + first) / float(most) * min(everything, 1.0) < running; ++taken) {
        vec2 u = vec2(uvec2(shift + taken * uvec2(3242174889u, 2447445414u)) >> 8u) * (1.0 / 16777216.0);
        vec3 facing;
        float inside = u.x;
        if (begin != end) {
            float before = begin > 0u ? emitter[triangleAt(begin - 1u)].w : 0.0;
            float pick = before + u.x * (emitter[triangleAt(end - 1u)].w - before);
            uint low = begin, high = end - 1u;
            while (low < high) {
                uint middle = (low + high) / 2u;
                if (emitter[triangleAt(middle)].w > pick) high = middle;
                else low = middle + 1u;
            }
            float below = low > 0u ? emitter[triangleAt(low - 1u)].w : 0.0, width = emitter[triangleAt(low)].w - below;
            inside = width > 0 ? clamp((pick - below) / width, 0.0, 0.999999) : 0.5;
            for (uint k = 0u; k < 3u; ++k) c[k] = emitter[triangleAt(low) + k].xyz;
            facing = emitter[triangleAt(low) + 3u].xyz;
        } else {
            facing = normalize(cross(c[1] - c[0], c[2] - c[0]));
        }
        float root = sqrt(inside);
        vec3 target = (1 - root) * c[0] + root * (1 - u.y) * c[1] + root * u.y * c[2];
        vec3 straight = target - point;
        float d2 = dot(straight, straight), height = dot(straight, normal), cosine = -dot(straight, facing);
        if (!(d2 > 0) || height <= 0 || (cosine <= 0 && !twoSided)) continue;
        float w = min(8.0, height * abs(cosine) * area / (pi * d2 * d2 * factor * scale));
        vec3 to = target - origin;
        float far = length(to);
        if (!(far > 0)) continue;
        allWeight += w;
        if (!occluded(to / far, max(0.0, far * (1 - 1e-4) - 8 * offset))) seen += w;
    }
}

float triangleFormFactor(vec3 c[3]) {
    vec3 face = cross(c[1] - c[0], c[2] - c[0]);
    if (!twoSided && dot(face, point - c[0]) <= 0) return 0;
    vec3 kept[4];
    int number = 0;
    for (int i = 0; i < 3; ++i) {
        vec3 a = c[i] - point, b = c[(i + 1) % 3] - point;
        float ha = dot(a, normal), hb = dot(b, normal);
        if (ha >= 0) kept[number++] = a;
        if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) kept[number++] = a + (b - a) * (ha / (ha - hb));
    }
    if (number < 3) return 0;
    for (int i = 0; i < number; ++i) {
        float size = length(kept[i]);
        if (!(size > 1e-18)) return 0;
        kept[i] /= size;
    }
    float sum = 0;
    for (int i = 0; i < number; ++i) {
        vec3 a = kept[i], b = kept[(i + 1) % number], normalTo = cross(a, b);
        float sine = length(normalTo);
        if (sine < 1e-12) continue;
        sum += atan(sine, dot(a, b)) / sine * dot(normalTo, normal);
    }
    return clamp(abs(sum) / (2 * pi), 0.0, 1.0);
}

void component(bool sampling, uint begin, uint end, vec3 c[3], float area, float factor) {
    if (sampling) take(begin, end, c, area, factor);
    else everything += factor;
}

// A triangle, near ones in quarters of quarters. `path`: which quarter at each depth, two bits each.
void addTriangle(bool sampling, uint t, float radius) {
    uint path = 0u, depth = 0u;
    do {
        vec3 c[3];
        for (uint k = 0u; k < 3u; ++k) c[k] = emitter[t + k].xyz;
        float r = radius;
        for (uint d = 0u; d < depth; ++d) {
            vec3 m0 = (c[0] + c[1]) / 2, m1 = (c[1] + c[2]) / 2, m2 = (c[2] + c[0]) / 2;
            uint which = path >> (2u * d) & 3u;
            if (which == 0u) { c[1] = m0; c[2] = m2; }
            else if (which == 1u) { c[0] = m0; c[2] = m1; }
            else if (which == 2u) { c[0] = m2; c[1] = m1; }
            else { c[0] = m0; c[1] = m1; c[2] = m2; }
            r /= 2;
        }
        vec3 to = (c[0] + c[1] + c[2]) / 3 - point;
        if (depth < splits && dot(to, to) < 16 * r * r) {
            path &= ~(3u << (2u * depth));
            ++depth;
            continue;
        }
        float factor = triangleFormFactor(c);
        if (factor > 0) component(sampling, 0u, 0u, c, length(cross(c[1] - c[0], c[2] - c[0])) / 2, factor);
        while (depth > 0u && (path >> (2u * (depth - 1u)) & 3u) == 3u) --depth;
        if (depth > 0u) path += 1u << (2u * (depth - 1u));
    } while (depth > 0u);
}

void cut(bool sampling) {
    for (uint at = 0u; at < emitterNodes;) {
        if (sampling && taken >= last) return;
        vec4 place = emitter[4u * at], flat_ = emitter[4u * at + 1u], axis = emitter[4u * at + 2u], rest = emitter[4u * at + 3u];
        uint begin = floatBitsToUint(rest.y), end = floatBitsToUint(rest.z), skip = floatBitsToUint(rest.w);
        bool single = end - begin == 1u;
        vec3 to = place.xyz - point;
        float d2 = dot(to, to), height = dot(to, normal), r = place.w;
        if (height < -r) {
            at = skip;
            continue;
        }
        float facing = -dot(to, axis.xyz), rim = rest.x * sqrt(d2) + r;
        bool cone = axis.w > 0;
        if (!twoSided && cone && facing < -rim) {
            at = skip;
            continue;
        }
        bool even = single || axis.w > tolerance.y || (cone && abs(facing) > rim);
        if (even && height > tolerance.z * r && r * r < tolerance.x * tolerance.x * d2) {
            float toward = -dot(to, flat_.xyz);
            if (twoSided) toward = abs(toward);
            float width = 0.75 * rest.x * sqrt(d2) * flat_.w;
            if (!twoSided && !single && abs(toward) < width) toward = (toward + width) * (toward + width) / (4 * width);
            at = skip;
            if (!(toward > 0)) continue;
            vec3 none[3];
            none[0] = none[1] = none[2] = vec3(0);
            component(sampling, begin, end, none, flat_.w, height * toward / (pi * d2 * d2));
        } else if (!single) {
            ++at;
        } else {
            addTriangle(sampling, triangleAt(begin), r);
            at = skip;
        }
    }
}

void main() {
    uint place = gl_GlobalInvocationID.x;
    if (place >= count) return;
    uint v = wanted[place];
    point = vec3(positions[3u * v], positions[3u * v + 1u], positions[3u * v + 2u]);
    normal = vec3(normals[3u * v], normals[3u * v + 1u], normals[3u * v + 2u]);
    vec3 toward = sphere.xyz - point;
    most = mayDouble && dot(toward, toward) < 6.25 * sphere.w * sphere.w ? 2u * samples : samples;
    taken = from;
    last = min(to, most);
    if (from > 0u && taken >= last) return;
    vec2 before = from > 0u ? answers[place] : vec2(0);
    answers[place] = vec2(0);
    if (dot(toward, normal) < -sphere.w) return;
    everything = 0;
    cut(false);
    if (!(everything > 0)) return;
    float open = min(everything, 1.0);
    answers[place] = vec2(open);
    if (!shadows) return;
    scale = everything > 1 ? 1 / everything : 1;
    origin = point + normal * (4 * offset);
    float range = length(toward), reach = range > sphere.w ? asin(min(1.0, sphere.w / range)) : pi;
    vec3 axis = range > 0 ? toward / range : normal;
    between = 0u;
    for (uint b = 0u; b < min(partCount, 32u); ++b) {
        vec4 ball = parts[5u * b + 3u];
        vec3 there = ball.xyz - point;
        float d = length(there);
        bool covers = d <= ball.w * 1.0001;
        if (!covers && d - ball.w <= range + sphere.w) {
            float angle = reach + asin(ball.w / d);
            covers = angle >= pi || dot(there, axis) >= d * cos(angle);
        }
        if (covers) between |= 1u << b;
    }
    uvec2 own = mixBits(seed ^ uvec2(0u, v));
    uvec2 h = mixBits(mixBits(mixBits(own) ^ uvec2(0u, 0x51u)) ^ uvec2(0u, 0x7fu));
    shift = uvec2(h.x & 0xffffff00u, mixBits(h).x & 0xffffff00u);
    first = unitFloat(mixBits(own ^ uvec2(0u, 0x9du)).x >> 8u);
    running = 0;
    seen = before.x;
    allWeight = before.y;
    cut(true);
    if (last < most) answers[place] = vec2(seen, allWeight);
    else if (allWeight > 0) answers[place].x = open * (seen / allWeight);
}
