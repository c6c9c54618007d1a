#version 430 core
in vec3 vertexColour;
in vec3 place;
uniform float kind;      // alpha of the scene image: 1 scene-linear, 2 display values
layout(location = 0) out vec4 scene;

// Programs are apart by TEXTURED, because software rasterisers evaluate both sides of a branch.
//EXTRA

#ifdef TEXTURED
uniform sampler2D detail;  // a factor on the colour
uniform int inPlace;       // 1: stands in place of it
in float shade;
layout(std430, binding = 0) readonly buffer Positions { float positions[]; };
layout(std430, binding = 1) readonly buffer Corners { uint corners[]; };
layout(std430, binding = 2) readonly buffer Texcoords { vec2 texcoords[]; };

vec3 positionOf(int corner) {
    uint v = corners[3 * gl_PrimitiveID + corner];
    return vec3(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
}

// The colour with the texture at this place of the triangle.
vec3 colourHere() {
    vec2 t0 = texcoords[3 * gl_PrimitiveID];
    if (t0.x < 0.0) return vertexColour;
    vec3 p0 = positionOf(0);
    vec3 a = positionOf(1) - p0, b = positionOf(2) - p0, c = place - p0;
    float aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), ca = dot(c, a), cb = dot(c, b);
    float area = aa * bb - ab * ab;
    if (area <= 0.0) return vertexColour;
    float u = (bb * ca - ab * cb) / area, v = (aa * cb - ab * ca) / area;
    vec2 at = t0 + u * (texcoords[3 * gl_PrimitiveID + 1] - t0) + v * (texcoords[3 * gl_PrimitiveID + 2] - t0);
    return textureLod(detail, at, 0.0).rgb * (inPlace == 1 ? vec3(shade) : vertexColour);
}
#else
vec3 colourHere() { return vertexColour; }
#endif

void main() {
    vec3 colour = colourHere();
    // Half floats end at 65504; what is brighter stays brighter than everything else.
    scene = vec4(clamp(colour, vec3(0.0), vec3(60000.0)), kind);
}
