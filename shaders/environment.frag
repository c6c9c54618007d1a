#version 430 core
// The distant environment as backdrop, from a latitude-longitude image (centre +X, to the right -Y, top +Z).
in vec2 place;
uniform mat4 worldFromClip;
uniform vec3 forward;
uniform int orthographic;
uniform sampler2D latLong;
uniform float yaw;      // radians that the image is turned about +Z
uniform vec3 gain;
uniform vec3 sides[6];  // factors on light from +X, -X, +Y, -Y, +Z and -Z
layout(location = 0) out vec4 scene;

void main() {
    vec2 ndc = place * 2.0 - 1.0;
    vec4 near = worldFromClip * vec4(ndc, -1.0, 1.0), far = worldFromClip * vec4(ndc, 1.0, 1.0);
    vec3 d = orthographic == 1 ? forward : normalize(far.xyz / far.w - near.xyz / near.w);
    vec2 uv = vec2(0.5 - (atan(d.y, d.x) - yaw) / 6.283185307, 0.5 - asin(clamp(d.z, -1.0, 1.0)) / 3.141592654);
    vec3 part = d * d;
    vec3 factor = gain * (part.x * sides[d.x > 0.0 ? 0 : 1] + part.y * sides[d.y > 0.0 ? 2 : 3] +
                          part.z * sides[d.z > 0.0 ? 4 : 5]);
    scene = vec4(clamp(factor * textureLod(latLong, uv, 0.0).rgb, vec3(0.0), vec3(60000.0)), 1.0);
}
