#include "viewer/render/shaders.h"

namespace armature::viewer::shaders {

const Source kTriangles = {"triangles", R"glsl(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in uint flags;
layout(location = 3) in vec3 colour;
uniform mat4 view_from_local;
uniform mat4 clip_from_view;
out vec3 view_normal;
out vec3 corner_colour;
out vec3 barycentric;
flat out uint face_flags;
void main() {
  view_normal = mat3(view_from_local) * normal;
  corner_colour = colour;
  face_flags = flags;
  barycentric = vec3(gl_VertexID % 3 == 0, gl_VertexID % 3 == 1, gl_VertexID % 3 == 2);
  gl_Position = clip_from_view * (view_from_local * vec4(position, 1));
}
)glsl",
                           R"glsl(#version 330 core
in vec3 view_normal;
in vec3 corner_colour;
in vec3 barycentric;
flat in uint face_flags;
uniform vec3 line_colour;
uniform vec3 inside_colour;
uniform float line_width;  // in samples
layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 normal;
const uint kLines = 1u, kTwoSided = 2u, kOneSided = 4u;
void main() {
  bool behind = !gl_FrontFacing;
  if (behind && (face_flags & kOneSided) != 0u) discard;
  albedo = vec4(behind && (face_flags & kTwoSided) == 0u ? inside_colour : corner_colour, 1);
  if ((face_flags & kLines) != 0u) {
    vec3 step = fwidth(barycentric);
    vec3 away = barycentric / step;  // samples from each side
    float line = 1 - smoothstep(0.5 * line_width, 0.5 * line_width + 1, min(away.x, min(away.y, away.z)));
    // Where triangles are hardly larger than lines these would cover all.
    float room = 1 / max(step.x, max(step.y, step.z));
    albedo.rgb = mix(albedo.rgb, line_colour, 0.8 * line * smoothstep(line_width, 6 * line_width, room));
  }
  vec3 n = normalize(view_normal);
  normal = vec4(behind ? -n : n, 0);
}
)glsl"};

const Source kBalls = {"balls", R"glsl(#version 330 core
layout(location = 0) in vec4 sphere;  // centre, radius
layout(location = 1) in vec3 colour;
uniform mat4 view_from_local;
uniform mat4 clip_from_view;
uniform float view_scale;
flat out vec4 ball;
flat out vec3 ball_colour;
out vec3 point;
void main() {
  ball = vec4((view_from_local * vec4(sphere.xyz, 1)).xyz, view_scale * sphere.w);
  ball_colour = colour;
  // A square across the line of sight through the centre, as wide as the cone of rays that touch the sphere.
  float away = length(ball.xyz);
  vec3 ahead = ball.xyz / away;
  vec3 right = normalize(cross(ahead, abs(ahead.y) < 0.9 ? vec3(0, 1, 0) : vec3(1, 0, 0)));
  vec3 up = cross(right, ahead);
  float sine = min(ball.w / away, 0.999);
  float wide = 1.01 * ball.w / sqrt(1 - sine * sine);
  point = ball.xyz + wide * ((gl_VertexID & 1) * 2 - 1) * right + wide * ((gl_VertexID & 2) - 1) * up;
  gl_Position = clip_from_view * vec4(point, 1);
}
)glsl",
                       R"glsl(#version 330 core
flat in vec4 ball;
flat in vec3 ball_colour;
in vec3 point;
uniform mat4 clip_from_view;
layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 normal;
void main() {
  vec3 ray = normalize(point);
  float nearest = dot(ray, ball.xyz);
  vec3 across = ball.xyz - nearest * ray;
  float half_chord2 = ball.w * ball.w - dot(across, across);
  if (half_chord2 < 0) discard;
  vec3 hit = (nearest - sqrt(half_chord2)) * ray;
  albedo = vec4(ball_colour, 1);
  normal = vec4((hit - ball.xyz) / ball.w, 0);
  vec4 clip = clip_from_view * vec4(hit, 1);
  gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
}
)glsl"};

const Source kCones = {"cones", R"glsl(#version 330 core
layout(location = 0) in vec4 sphere_a;  // centre, radius
layout(location = 1) in vec4 sphere_b;
layout(location = 2) in vec3 colour;
uniform mat4 view_from_local;
uniform mat4 clip_from_view;
uniform float view_scale;
flat out vec4 a;
flat out vec4 b;
flat out vec3 cone_colour;
out vec3 point;
void main() {
  a = vec4((view_from_local * vec4(sphere_a.xyz, 1)).xyz, view_scale * sphere_a.w);
  b = vec4((view_from_local * vec4(sphere_b.xyz, 1)).xyz, view_scale * sphere_b.w);
  cone_colour = colour;
  // The contact circles lie at c - r g u with radius r sqrt(1 - g^2); a square around each.
  float l = length(b.xyz - a.xyz);
  vec3 u = (b.xyz - a.xyz) / l;
  float g = (b.w - a.w) / l;
  float cosine = sqrt(max(1 - g * g, 0));
  vec3 v = normalize(cross(u, abs(u.y) < 0.9 ? vec3(0, 1, 0) : vec3(1, 0, 0)));
  vec3 w = cross(u, v);
  // A cube as one strip: the bits of three numbers, by corner.
  int bit = 1 << gl_VertexID;
  vec4 end = (0x287a & bit) != 0 ? b : a;
  float wide = end.w * cosine * 1.001;
  point = end.xyz - end.w * g * u + wide * ((0x02af & bit) != 0 ? v : -v) + wide * ((0x31e3 & bit) != 0 ? w : -w);
  gl_Position = clip_from_view * vec4(point, 1);
}
)glsl",
                       R"glsl(#version 330 core
flat in vec4 a;
flat in vec4 b;
flat in vec3 cone_colour;
in vec3 point;
uniform mat4 clip_from_view;
layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 normal;
void main() {
  vec3 ray = normalize(point);
  vec3 axis = b.xyz - a.xyz;
  float l = length(axis);
  vec3 u = axis / l;
  float g = (b.w - a.w) / l;
  float cosine2 = 1 - g * g;
  // From where the ray passes the cone's middle: small numbers, few digits lost.
  float start = dot(0.5 * (a.xyz + b.xyz), ray);
  vec3 from_a = start * ray - a.xyz;
  float along_0 = dot(from_a, u), along_1 = dot(ray, u);
  vec3 away_0 = from_a - along_0 * u, away_1 = ray - along_1 * u;
  // cosine^2 |away|^2 = (r_a + g along)^2, along the ray.
  float size_0 = a.w + g * along_0, size_1 = g * along_1;
  float k2 = cosine2 * dot(away_1, away_1) - size_1 * size_1;
  float k1 = cosine2 * dot(away_0, away_1) - size_0 * size_1;
  float k0 = cosine2 * dot(away_0, away_0) - size_0 * size_0;
  float discriminant = k1 * k1 - k2 * k0;
  if (discriminant < 0) discard;
  float root = sqrt(discriminant);
  // Without cancellation.
  float q = -(k1 + (k1 < 0 ? -root : root));
  vec2 ts = vec2(q / k2, k0 / q);
  ts = vec2(min(ts.x, ts.y), max(ts.x, ts.y));
  for (int i = 0; i < 2; ++i) {
    float t = ts[i];
    float blend = (along_0 + t * along_1 + a.w * g) / (l * cosine2);
    if (!(blend >= 0 && blend <= 1)) continue;
    vec3 n = normalize(from_a + t * ray - blend * axis);
    if (dot(n, ray) > 0) continue;
    albedo = vec4(cone_colour, 1);
    normal = vec4(n, 0);
    vec4 clip = clip_from_view * vec4((start + t) * ray, 1);
    gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
    return;
  }
  discard;
}
)glsl"};

/// One triangle that covers the picture.
constexpr const char* kWholePicture = R"glsl(#version 330 core
void main() {
  gl_Position = vec4((gl_VertexID & 1) * 4 - 1, (gl_VertexID & 2) * 2 - 1, 0, 1);
}
)glsl";

// Ambient obscurance after McGuire, Mara, Luebke: Scalable Ambient Obscurance (HPG 2012), equation 10, without its
// hierarchy of depths.
const Source kLight = {"light", kWholePicture, R"glsl(#version 330 core
uniform sampler2D albedo_map;
uniform sampler2D normal_map;
uniform sampler2D depth_map;
uniform sampler2D solid_depth_map;  // of what is not glass
uniform bool glass;
uniform bool obscurance;
uniform vec2 tangents;        // half the view's width and height at depth 1
uniform vec2 depth_of_clip;   // z = -y / (ndc + x)
uniform float reach;          // how far obscurance reaches, in units of the view
uniform vec3 background_top;
uniform vec3 background_bottom;
layout(location = 0) out vec4 light;
const int kSamples = 14;
const float kTurns = 5;

vec3 linear(vec3 srgb) {
  return mix(srgb / 12.92, pow((srgb + 0.055) / 1.055, vec3(2.4)), greaterThan(srgb, vec3(0.04045)));
}

vec3 point_at(ivec2 pixel) {
  float depth = texelFetch(depth_map, pixel, 0).r;
  float z = -depth_of_clip.y / (2 * depth - 1 + depth_of_clip.x);
  vec2 screen = 2 * (vec2(pixel) + 0.5) / vec2(textureSize(depth_map, 0)) - 1;
  return vec3(-z * tangents * screen, z);
}

float openness(ivec2 pixel, vec3 p, vec3 n) {
  ivec2 size = textureSize(depth_map, 0);
  float reach_px = 0.5 * float(size.y) * reach / (tangents.y * -p.z);
  uint hash = (3u * uint(pixel.x) ^ uint(pixel.y)) + 10u * uint(pixel.x) * uint(pixel.y);
  float turn = 0.7853 * float(hash % 64u);
  float sum = 0;
  for (int i = 0; i < kSamples; ++i) {
    float share = (float(i) + 0.5) / float(kSamples);
    float angle = share * kTurns * 6.2831853 + turn;
    ivec2 at = pixel + ivec2(round(reach_px * share * vec2(cos(angle), sin(angle))));
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) continue;
    vec3 v = point_at(at) - p;
    float vv = dot(v, v) / (reach * reach);
    float vn = dot(v, n) / reach - 0.015;
    float falloff = max(1 - vv, 0);
    sum += falloff * falloff * falloff * max(vn / (vv + 0.01), 0);
  }
  return max(0, 1 - 3.2 * sum / float(kSamples));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float depth = texelFetch(depth_map, pixel, 0).r;
  if (depth == 1) {
    if (glass) discard;
    float height = (float(pixel.y) + 0.5) / float(textureSize(depth_map, 0).y);
    light = vec4(linear(mix(background_bottom, background_top, height)), 1);
    return;
  }
  if (glass && depth >= texelFetch(solid_depth_map, pixel, 0).r) discard;
  vec3 colour = linear(texelFetch(albedo_map, pixel, 0).rgb);
  vec3 n = normalize(texelFetch(normal_map, pixel, 0).xyz);
  vec3 p = point_at(pixel);
  vec3 to_eye = normalize(-p);
  float open = glass || !obscurance ? 1 : openness(pixel, p, n);

  // Key from above left, fill from the right, sky and ground.
  const vec3 kKey = normalize(vec3(-0.45, 0.75, 0.65)), kFill = normalize(vec3(0.85, 0.15, 0.5));
  float key = max(dot(n, kKey), 0), fill = max(dot(n, kFill), 0);
  vec3 sky = mix(vec3(0.22, 0.20, 0.19), vec3(0.40, 0.42, 0.46), 0.5 + 0.5 * n.y);
  float gloss = pow(max(dot(n, normalize(kKey + to_eye)), 0), 48.0);
  float facing = max(dot(n, to_eye), 0);
  float rim = pow(1 - facing, 4.0);
  vec3 sum = colour * (open * sky + mix(open, 1, 0.6) * (vec3(0.82, 0.80, 0.76) * key + vec3(0.16, 0.18, 0.22) * fill));
  sum += open * (0.07 * gloss + 0.06 * rim);
  // Thin glass covers more where it is seen at a slant.
  light = vec4(min(sum, 1), glass ? mix(0.30, 0.85, pow(1 - facing, 1.5)) : 1);
}
)glsl"};

const Source kResolve = {"resolve", kWholePicture, R"glsl(#version 330 core
uniform sampler2D light_map;
uniform int samples;  // a side
layout(location = 0) out vec4 srgb;
void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * samples;
  vec3 sum = vec3(0);
  for (int y = 0; y < samples; ++y)
    for (int x = 0; x < samples; ++x) sum += texelFetch(light_map, first + ivec2(x, y), 0).rgb;
  vec3 linear = sum / float(samples * samples);
  srgb = vec4(mix(12.92 * linear, 1.055 * pow(linear, vec3(1 / 2.4)) - 0.055, greaterThan(linear, vec3(0.0031308))), 1);
}
)glsl"};

}  // namespace armature::viewer::shaders
