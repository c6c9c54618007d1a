#version 430 core
in vec3 vertexColour;
uniform float kind;      // alpha of the scene image: 1 scene-linear, 2 display values
layout(location = 0) out vec4 scene;

void main() {
    // Half floats end at 65504; what is brighter stays brighter than everything else.
    scene = vec4(clamp(vertexColour, vec3(0.0), vec3(60000.0)), kind);
}
