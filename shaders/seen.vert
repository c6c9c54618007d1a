#version 430 core
layout(location = 0) in vec3 position;
uniform mat4 clipFromWorld;
invariant gl_Position;  // as in mesh.vert, to the bit

void main() { gl_Position = clipFromWorld * vec4(position, 1.0); }
