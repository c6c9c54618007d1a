#version 430 core
// An image behind the mesh or in its place: the photograph, or a frame rendered at rest (premultiplied by its coverage). Row 0 is the top.
in vec2 place;
uniform sampler2D image;
layout(location = 0) out vec4 scene;

void main() {
    vec4 c = texture(image, vec2(place.x, 1.0 - place.y));
    scene = vec4(clamp(c.rgb, vec3(0.0), vec3(60000.0)), c.a);
}
