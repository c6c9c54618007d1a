#version 430 core
// The distant environment as backdrop, from a latitude-longitude image (centre +X, to the right -Y, top +Z).
in vec2 place;
uniform mat4 worldFromClip;
uniform vec3 forward;
uniform int orthographic;
uniform sampler2D latLong;
layout(location = 0) out vec4 scene;

void main() {
    vec2 ndc = place * 2.0 - 1.0;
    vec4 near = worldFromClip * vec4(ndc, -1.0, 1.0), far = worldFromClip * vec4(ndc, 1.0, 1.0);
    vec3 d = orthographic == 1 ? forward : normalize(far.xyz / far.w - near.xyz / near.w);
    vec2 uv = vec2(0.5 - atan(d.y, d.x) / 6.283185307, 0.5 - asin(clamp(d.z, -1.0, 1.0)) / 3.141592654);
    scene = vec4(clamp(textureLod(latLong, uv, 0.0).rgb, vec3(0.0), vec3(60000.0)), 1.0);
}
