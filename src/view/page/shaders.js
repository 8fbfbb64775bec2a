"use strict";
// Colours are as in the pictures: plain sRGB numbers, lit by the same two lights on both sides.
const SHADERS = (() => {
  const common = `
    uniform vec3 low;
    uniform vec3 extent;
    uniform float size;
    uniform float pixel; // the height of a pixel at distance 1
    vec3 place(vec3 part) { return low + part * extent; }
    // Nearer to the eye by a part of the distance: ink on the surface wins against the surface.
    vec4 inked(vec3 p, float bias) {
      return projectionMatrix * viewMatrix * vec4(mix(p, cameraPosition, bias), 1.0);
    }`;
  // The edge of a band along a direction, turned to the eye.
  const ribbon = `
    attribute vec3 along;
    attribute float side;
    vec3 ribbon(vec3 p, float width) {
      vec3 across = cross(along, cameraPosition - p);
      float length_ = length(across);
      if (length_ < 1e-20) return p;
      float least = pixel * distance(cameraPosition, p);
      return p + across / length_ * side * 0.5 * max(width, least);
    }`;
  const ramp = `
    uniform sampler2D ramp;
    uniform vec2 scale; // of the range, what the ends of the colours stand for
    float part(float value) { return clamp((value - scale.x) / (scale.y - scale.x), 0.0, 1.0); }
    vec3 colour(float value) { return texture2D(ramp, vec2((part(value) * 255.0 + 0.5) / 256.0, 0.5)).rgb; }`;

  const surface = {
    vertexShader: common + `
      attribute float value;
      varying vec3 toNormal, toEye;
      varying float amount;
      void main() {
        vec3 p = place(position);
        toNormal = normal;
        toEye = cameraPosition - p;
        amount = value;
        gl_Position = projectionMatrix * viewMatrix * vec4(p, 1.0);
      }`,
    fragmentShader: ramp + `
      uniform bool coloured;
      uniform vec3 plain, key, fill, brightness;
      uniform float bands;
      varying vec3 toNormal, toEye;
      varying float amount;
      void main() {
        vec3 n = normalize(toNormal);
        if (dot(n, toEye) < 0.0) n = -n;
        vec3 ink = plain;
        if (coloured) {
          ink = colour(amount);
          if (bands > 0.0) {
            // Every other band is darker; their borders are as soft as a pixel.
            float x = part(amount) * bands, soft = max(fwidth(x), 1e-4);
            float f = abs(fract(x * 0.5 - 0.25) - 0.5) * 2.0; // of period 2, 0 in the middle of dark bands
            ink *= 1.0 - 0.07 * clamp((0.5 - f) / soft + 0.5, 0.0, 1.0);
          }
        }
        float light = brightness.x + brightness.y * max(dot(n, key), 0.0) + brightness.z * max(dot(n, fill), 0.0);
        gl_FragColor = vec4(ink * light, 1.0);
      }`,
  };

  const mesh = {
    vertexShader: common + `void main() { gl_Position = inked(place(position), 0.002); }`,
    fragmentShader: `void main() { gl_FragColor = vec4(0.1, 0.12, 0.17, 0.38); }`,
  };

  // The cage and the creases.
  const line = {
    vertexShader: common + ribbon + `
      attribute float strength;
      uniform float width, bias;
      varying float opacity;
      void main() {
        opacity = strength;
        gl_Position = inked(ribbon(place(position), width * size), bias);
      }`,
    fragmentShader: `
      uniform vec3 ink;
      uniform float alpha;
      varying float opacity;
      void main() { gl_FragColor = vec4(ink, alpha * opacity); }`,
  };

  // Times are in crossings of the surface at full speed.
  const stroke = {
    vertexShader: common + ribbon + `
      attribute vec4 info; // time, speed, phase, how long its line lasts
      uniform float duration, width;
      uniform bool over;
      varying float time, last, speed, across, phase;
      void main() {
        time = info.x * duration;
        speed = info.y;
        phase = info.z;
        last = info.w * duration;
        across = side;
        gl_Position = inked(ribbon(place(position), width * size * (over ? 0.5 : 1.0)), 0.0025);
      }`,
    fragmentShader: ramp + `
      uniform float clock, period;
      uniform bool still, over;
      varying float time, last, speed, across, phase;
      void main() {
        float t = last > 0.0 ? clamp(time / last, 0.0, 1.0) : 0.0;
        float thick, alpha;
        if (still) { // pointed where it comes from, round where it goes
          thick = t * (1.0 - pow(t, 8.0));
          alpha = 1.0;
        } else { // drops that drift, thin out behind and fade in and out with their line
          float age = mod(clock - time + phase * period, period) / period;
          float tail = 1.0 - age / 0.55;
          thick = tail > 0.0 ? tail : 0.0;
          thick = max(thick * smoothstep(0.0, 0.02, age), 0.16);
          alpha = max(0.25, tail) * min(1.0, 6.0 * min(t, 1.0 - t) + 0.02);
        }
        float soft = max(fwidth(across), 1e-3);
        alpha *= clamp((thick - abs(across)) / soft + 0.5, 0.0, 1.0);
        if (alpha < 0.01) discard;
        gl_FragColor = over ? vec4(0.08, 0.10, 0.14, 0.4 * alpha) : vec4(colour(speed), alpha);
      }`,
  };

  const arrow = {
    vertexShader: common + ramp + `
      attribute vec3 at, along, up;
      attribute float value;
      uniform bool over;
      uniform vec2 lengths; // at rest, at full speed
      varying vec3 ink;
      void main() {
        float grown = part(value);
        vec3 side = cross(up, along);
        vec3 p = place(at) + (along * position.x + side * position.y) * mix(lengths.x, lengths.y, grown) * size;
        ink = over ? vec3(0.08, 0.10, 0.14) : colour(value);
        gl_Position = inked(p, 0.006);
      }`,
    fragmentShader: `
      varying vec3 ink;
      void main() { gl_FragColor = vec4(ink, 1.0); }`,
  };

  const zero = {
    vertexShader: common + `
      attribute vec3 at, fill;
      varying vec3 ink;
      varying vec2 corner;
      void main() {
        ink = fill;
        corner = position.xy;
        vec4 p = viewMatrix * vec4(mix(at, cameraPosition, 0.01), 1.0);
        float radius = max(0.0105 * size, -5.5 * pixel * p.z);
        gl_Position = projectionMatrix * (p + vec4(corner * radius, 0.0, 0.0));
      }`,
    fragmentShader: `
      varying vec3 ink;
      varying vec2 corner;
      void main() {
        float r = length(corner), soft = fwidth(r);
        float inside = clamp((1.0 - r) / soft, 0.0, 1.0);
        gl_FragColor = vec4(mix(vec3(1.0), ink, clamp((0.8 - r) / soft + 0.5, 0.0, 1.0)), inside);
      }`,
  };
  return { surface, mesh, line, stroke, arrow, zero };
})();
