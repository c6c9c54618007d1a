#version 430 core
// Lines of the floor grid and the cameras.
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 colour;
uniform mat4 clipFromWorld;
out vec4 vertexColour;

void main() {
    gl_Position = clipFromWorld * vec4(position, 1.0);
    // A hair farther, so that the grid is not torn by a floor at the same height, which hides it.
    gl_Position.z += 1e-4 * gl_Position.w;
    vertexColour = colour;
}
