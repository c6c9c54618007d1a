#version 430 core
// One triangle that covers the image; `place` runs from (0, 0) bottom left to (1, 1) top right.
out vec2 place;

void main() {
    place = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
    gl_Position = vec4(place * 2.0 - 1.0, 0.0, 1.0);
}
