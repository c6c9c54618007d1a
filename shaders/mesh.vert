#version 430 core
// A mesh with one colour a vertex.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 colour;
uniform mat4 clipFromWorld;
uniform vec3 eye;        // place of the eye, or with orthographic 1 the direction towards it
uniform int orthographic;
uniform int shading;     // 0: colours as they are, 1: a soft light at the eye, so that form stays readable
out vec3 vertexColour;
out vec3 place;
out float shade;
invariant gl_Position;  // as in seen.vert, to the bit

void main() {
    gl_Position = clipFromWorld * vec4(position, 1.0);
    shade = 1.0;
    if (shading == 1) {
        vec3 towardEye = orthographic == 1 ? eye : normalize(eye - position);
        shade = 0.42 + 0.58 * abs(dot(normal, towardEye));
    }
    vertexColour = colour * shade;
    place = position;
}
