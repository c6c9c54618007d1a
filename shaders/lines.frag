#version 430 core
in vec4 vertexColour;
layout(location = 0) out vec4 screen;

void main() {
    screen = vertexColour;
}
