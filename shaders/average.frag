#version 430 core
// One more image into the average; the blending does the sum.
uniform sampler2D image;
layout(location = 0) out vec4 sum;

void main() {
    sum = vec4(texelFetch(image, ivec2(gl_FragCoord.xy), 0).rgb, 1.0);
}
