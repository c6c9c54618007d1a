#version 430 core
// From the scene image to the screen. Alpha of the scene image: 0 to 1 coverage of scene-linear colour (premultiplied) over the grey
// backdrop, 2 display values that are shown as they are.
in vec2 place;
uniform sampler2D scene;
uniform float exposure;
uniform int falseColour;
uniform vec3 bands[13];
layout(location = 0) out vec4 screen;

//EXTRA

vec3 shown(vec3 linear) {
    vec3 c = linear * exposure;
    if (falseColour == 1) {
        float y = dot(c, vec3(0.2126, 0.7152, 0.0722));
        float stops = y > 0.0 ? log2(y / 0.18) : -100.0;
        return bands[int(clamp(floor(stops + 0.5), -6.0, 6.0)) + 6];
    }
    return clamp(displayTransform(vec4(c, 1.0)).rgb, 0.0, 1.0);
}

void main() {
    vec4 s = texelFetch(scene, ivec2(gl_FragCoord.xy), 0);
    vec3 result;
    if (s.a > 1.5) {
        result = s.rgb;
    } else {
        // A quiet grey that is darker at the bottom, one step of dither against bands.
        float dither = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
        vec3 backdrop = vec3(mix(0.125, 0.185, place.y) + dither / 255.0);
        result = backdrop;
        if (s.a > 0.0) result = mix(backdrop, shown(s.rgb / s.a), s.a);
    }
    screen = vec4(result, 1.0);
}
