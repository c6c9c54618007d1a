// Which cells of the environment a part hides from each slot: traceCone() of relight/live/visibility.cpp with a ray a
// cell. A lane is a slot, a group a chunk of 64 slots. Groups take room for their entries as they come; what they write
// there does not depend on the order.
layout(local_size_x = 64) in;

layout(std430, binding = 2) readonly buffer Positions { float positions[]; };  // a vertex: three
layout(std430, binding = 3) readonly buffer Slots { vec4 slots[]; };           // normal, vertex
layout(std430, binding = 4) readonly buffer Masks { uint masks[]; };           // eight cells a word
layout(std430, binding = 5) readonly buffer Grid { vec4 grid[]; };             // parents of two, then cells of six
layout(std430, binding = 6) buffer Header { uint header[]; };                  // words in use; a chunk: its first word, 64 counts
layout(std430, binding = 7) writeonly buffer Entries { uint entries[]; };      // two to a word

uniform uint slotCount, cells, side, parents, capacity, treeBegin, treeEnd;
uniform vec4 sphere, rowX, rowY, rowZ;  // the part's; part from world
uniform float offset;

const uint none = 0xffffffffu, room = 64u, few = 12u, many = 160u;

shared uint places[64];
shared uint base;
shared uint crowded;

vec3 point, normal, origin, axis;
float sine, cosine;
bool inside;
uint mine[room];
uint count;
bool whole, full;

bool meets(vec4 cap, float capSine) { return inside || dot(cap.xyz, axis) >= cap.w * cosine - capSine * sine; }
uint cellAt(uint c) { return 2u * parents + 6u * c; }
vec3 quarter(uint c, uint q) { return grid[cellAt(c) + 2u + q].xyz; }

bool hiddenInCone(uint c, uint seen) {
    if (inside) return true;
    vec4 angles = grid[cellAt(c) + 1u];
    float reach = cosine * angles.y - sine * angles.z;
    for (uint q = 0u; q < 4u; ++q) {
        if ((seen >> q & 1u) == 1u) continue;
        vec3 d = quarter(c, q);
        if (dot(d, normal) > 0 && dot(d, axis) > reach) return true;
    }
    return false;
}

bool hit(vec3 direction) {
    vec3 to = sphere.xyz - origin;
    float along = dot(to, direction), d2 = dot(to, to), r2 = sphere.w * sphere.w;
    if (d2 >= r2 && !(along > 0 && d2 - along * along < r2)) return false;
    vec4 place = vec4(origin, 1);
    return blocked(treeBegin, treeEnd, vec3(dot(rowX, place), dot(rowY, place), dot(rowZ, place)),
                   vec3(dot(rowX.xyz, direction), dot(rowY.xyz, direction), dot(rowZ.xyz, direction)), 1e30);
}

void trace(uint slot) {
    vec3 to = sphere.xyz - point;
    float d = length(to);
    inside = d <= sphere.w * 1.0001;
    axis = inside ? vec3(0, 0, 1) : to / d;
    sine = inside ? 0.0 : sphere.w / d;
    cosine = inside ? -1.0 : sqrt(max(0.0, 1 - sine * sine));
    if (!inside && dot(axis, normal) < -sine) return;
    origin = point + normal * (4 * offset);
    uint number = 0u, words = slot * (cells / 8u);
    bool entire = true;
    uint stride = 0u;
    for (uint pass = 0u; pass < 2u; ++pass) {
        for (uint p = 0u; p < parents; ++p) {
            vec4 rest = grid[2u * p + 1u];
            if (!meets(grid[2u * p], rest.x)) continue;
            uint asked = 0u, blocks = 0u;
            for (uint i = 0u; i < 16u; ++i) {
                uint c = floatBitsToUint(rest.y) + i / 4u * side + i % 4u;
                vec4 cap = grid[cellAt(c)];
                if (!meets(cap, grid[cellAt(c) + 1u].x)) continue;
                uint seen = masks[words + c / 8u] >> 4u * (c % 8u) & 15u;
                if (pass == 0u) {
                    if (seen != 0u) ++number;
                    if (entire && seen != 15u) entire = !hiddenInCone(c, seen);
                    continue;
                }
                if (seen == 0u) continue;
                uint square = stride == 2u ? 0u : stride == 1u ? i / 8u * 2u + i % 4u / 2u : i;
                if ((asked >> square & 1u) == 0u) {
                    asked |= 1u << square;
                    vec3 direction = cap.xyz;
                    if (dot(direction, normal) <= 0) direction = quarter(c, uint(findLSB(seen)));
                    if (hit(direction)) blocks |= 1u << square;
                }
                if ((blocks >> square & 1u) == 0u) continue;
                if (count >= 2u * room) {
                    full = true;
                    return;
                }
                uint entry = c << 4u | seen;
                if (count % 2u == 0u) mine[count / 2u] = entry;
                else mine[count / 2u] |= entry << 16u;
                ++count;
            }
        }
        if (pass == 0u) {
            if (number == 0u) return;
            whole = entire;
            stride = number > many ? 2u : number > few ? 1u : 0u;
        }
    }
}

void main() {
    uint slot = gl_GlobalInvocationID.x, lane = gl_LocalInvocationID.x, chunk = gl_WorkGroupID.x;
    count = 0u;
    whole = full = false;
    if (lane == 0u) crowded = 0u;
    memoryBarrierShared();
    barrier();
    uint vertex = slot < slotCount ? floatBitsToUint(slots[slot].w) : none;
    if (vertex != none) {
        point = vec3(positions[3u * vertex], positions[3u * vertex + 1u], positions[3u * vertex + 2u]);
        normal = slots[slot].xyz;
        trace(slot);
    }
    uint words = (count + 1u) / 2u;
    places[lane] = words;
    if (full) atomicMax(crowded, 1u);
    memoryBarrierShared();
    barrier();
    if (lane == 0u) {
        uint sum = 0u;
        for (uint i = 0u; i < 64u; ++i) {
            uint own = places[i];
            places[i] = sum;
            sum += own;
        }
        base = crowded == 1u ? none : atomicAdd(header[0], sum);
        header[1u + 65u * chunk] = base;
    }
    memoryBarrierShared();
    barrier();
    header[2u + 65u * chunk + lane] = count | (whole ? 0x80000000u : 0u);
    if (base == none) return;
    for (uint w = 0u; w < words; ++w)
        if (base + places[lane] + w < capacity) entries[base + places[lane] + w] = mine[w];
}
