#version 430 core
layout(location = 0) in vec3 position;
uniform mat4 clipFromWorld;

void main() {
    gl_Position = clipFromWorld * vec4(position, 1.0);
    gl_Position.z -= 1e-4 * gl_Position.w;
}
