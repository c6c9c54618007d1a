#version 430 core
// A line around the selected emitters, from a mask of where they are.
uniform sampler2D mask;
uniform vec4 colour;
uniform int radius;      // pixels
layout(location = 0) out vec4 screen;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(mask, 0) - 1;
    if (texelFetch(mask, at, 0).r > 0.5) discard;
    float most = 0.0;
    for (int y = -radius; y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x)
            if (x * x + y * y <= radius * radius + 1) most = max(most, texelFetch(mask, clamp(at + ivec2(x, y), ivec2(0), last), 0).r);
    if (most < 0.25) discard;
    screen = colour;
}
