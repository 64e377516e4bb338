#include "render/volume/volume_gl.h"

#include "render/scene/color_ramps.h"
#include "render/sorting/depth_sort_shaders.h"
#include "render/sorting/item_texels.h"
#include "render/volume/volume_lens.h"
#include "render/volume/volume_shaders.h"
#include "render/volume/volume_tile.h"

#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <variant>

namespace gs::render {
namespace {

constexpr std::size_t kMaxShaderLights = 8, kTransferAt = 19 + 5 * kMaxShaderLights, kItemTexels = kTransferAt + 256;
constexpr std::size_t kMaxVectors = std::size_t{1} << 28;
constexpr std::size_t kSurveyedVectors = 8192;  // vectors from which survey_volumes() estimates the work
// Maximum samples to blend. The CPU draws larger images, because it stops at opaque pixels. The system resets a driver
// that is busy for seconds.
constexpr double kMaxBlendedSamples = 2e10;
constexpr float kOwnColor = 5, kVectorColor = 6;  // colour sources in addition to ColorBy, as in volume_shaders.h

std::string defines() {
  std::string text;
  const auto define = [&](const char* name, const std::string& value) {
    text += std::string("#define ") + name + " " + value + "\n";
  };
  for (const auto& [name, value] : {std::pair{"FOOTPRINT", kVolumeFootprint},
                                    {"MOST_ALPHA", kVolumeMostAlpha},
                                    {"LEAST_ALPHA", kVolumeLeastAlpha},
                                    {"LEAST_AREA", kVolumePixel},
                                    {"CUT", kVolumeCut},
                                    {"PI", kVolumePi}}) {
    // std::to_string of a float would depend on the locale.
    const auto billionths = std::llround(double{value} * 1e9);
    const std::string digits = std::to_string(billionths % 1'000'000'000 + 1'000'000'000).substr(1);
    define(name, std::to_string(billionths / 1'000'000'000) + "." + digits);
  }
  define("MOST_LIGHTS", std::to_string(kMaxShaderLights));
  define("ITEM_TEXELS", std::to_string(kItemTexels));
  define("FIRST_OCTAVE", std::to_string(kFirstOctave));
  define("BLOCK_VECTORS", std::to_string(kBlockVectors));
  return text;
}

std::string volume_keys_shader() {
  return defines() + kVolumeItemShader + kItemsShader + kVolumeDataShader + kVolumeKeysShader;
}

/// Appends the texels of an item, in the layout of kVolumeItemShader. `start` is the index of its first vector among
/// all vectors.
void describe(const VolumeItem& item, const VolumeStore::Place& place, const VolumeLens& lens, std::size_t start,
              std::vector<glm::vec4>& out) {
  const VolumeOptions& options = item.options;
  const VolumeModel& model = *item.model;
  const auto lights = options.lights.empty() ? volume_headlight() : options.lights;
  for (int i = 0; i < 3; ++i) out.push_back(matrix_row(lens.camera_from_node, i));
  for (int i = 0; i < 3; ++i) out.push_back(matrix_row(glm::mat4(lens.normal_matrix), i));
  out.emplace_back(place.coding.lower, 0);
  out.emplace_back(place.coding.step, 0);
  out.emplace_back(integer_halves(start), integer_halves(place.first));
  out.emplace_back(integer_halves(item.volume->size()), 0, 0);
  out.emplace_back(place.coding.weight, 0, 0);
  out.push_back(options.clip.value_or(glm::vec4(0)));
  out.emplace_back(options.ambient, options.diffuse, options.specular, static_cast<float>(lights.size()));
  auto by = static_cast<float>(options.color_by);
  if (options.color_by == ColorBy::own && options.color) by = kOwnColor;
  if (options.color_by == ColorBy::own && !options.color && !item.volume->colors.empty()) by = kVectorColor;
  out.emplace_back(options.color.value_or(glm::vec3(0)), by);
  out.emplace_back(lens.scale, options.least_magnitude, model.full_magnitude,
                   options.opacity * (1 / (kVolumePi * kVolumeFootprint)));
  for (int i = 0; i < 3; ++i) {
    out.push_back(matrix_row(glm::mat4(options.fog.ranges_from_camera), i));
    out.back().w = options.fog.color[i];
  }
  out.emplace_back(!options.fog.on ? 0 : options.fog.exponential ? 2 : 1, options.fog.back, 0, 0);
  for (std::size_t i = 0; i < kMaxShaderLights; ++i) {
    const VolumeLight light = i < lights.size() ? lights[i] : VolumeLight{};
    out.emplace_back(light.place, light.directional ? 1 : 0);
    out.emplace_back(light.color, light.ambient);
    out.emplace_back(light.attenuation, light.radius);
    out.emplace_back(light.direction, light.cut_off_angle);
    out.emplace_back(light.beam_width, 0, 0, 0);
  }
  const VolumeTransfer& transfer = volume_transfer(model, options);
  out.insert(out.end(), transfer.begin(), transfer.end());
}

}  // namespace

VolumeGl::VolumeGl(const Gl& gl, SortMethod sort)
    : gl_(gl),
      store_(gl),
      order_(gl, sort, volume_keys_shader()),
      attributes_(make_vertex_array(gl)),
      items_(make_texture(gl)),
      order_texture_(make_texture(gl)) {}

bool VolumeGl::make_program_once() {
  if (!tried_program_) {
    tried_program_ = true;
    auto made = make_program(gl_, defines(),
                             std::string(kVolumeItemShader) + kItemsShader + kVolumeDataShader + kVolumeShadeShader +
                                 kRankShader + kVolumeVertexShader,
                             kVolumeFragmentShader);
    if (auto* program = std::get_if<Program>(&made)) program_ = std::move(*program);
  }
  return program_.name() != 0;
}

bool VolumeGl::upload_items(const Visible& visible, const SplatView& lens) {
  const PhaseScope phase(gl_.phases, Phase::upload);
  GLint most = 0;
  gl_.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  // The order has a texel per vector.
  if (std::max(visible.items.size() * kItemTexels, visible.total) > static_cast<std::size_t>(std::max(most, 0)))
    return false;
  std::vector<glm::vec4> texels;
  std::size_t start = 0;
  for (std::size_t i = 0; i < visible.items.size(); ++i) {
    const VolumeItem& item = visible.items[i];
    describe(item, visible.places[i], *volume_lens(lens, item.camera_from_node), start, texels);
    start += item.count;
  }
  return upload_item_texels(gl_, texels, item_buffer_, items_);
}

std::optional<DepthOrder::Result> VolumeGl::sort(const Visible& visible, std::uint32_t viewport) {
  std::vector<SortPart> parts(visible.items.size());
  for (std::size_t i = 0; i < visible.items.size(); ++i) {
    parts[i].vectors = visible.held[i].volume;
    parts[i].count = visible.items[i].count;
    parts[i].row = matrix_row(visible.items[i].camera_from_node, 2) * -1.0f;
  }
  return order_.order(viewport, parts, {store_.codes().name(), items_.name(), static_cast<int>(visible.items.size())});
}

void VolumeGl::draw_range(const Visible& visible, const View& view, const SplatRange& range) {
  gl_.UseProgram(program_.name());
  const auto at = [&](const char* name) { return gl_.GetUniformLocation(program_.name(), name); };
  const std::array<std::pair<const char*, GLuint>, 4> textures{{{"codes", store_.codes().name()},
                                                                {"items", items_.name()},
                                                                {"spacings", store_.spacings().name()},
                                                                {"order", order_texture_.name()}}};
  for (GLuint unit = 0; unit < textures.size(); ++unit) {
    gl_.ActiveTexture(GL_TEXTURE0 + unit);
    gl_.BindTexture(GL_TEXTURE_BUFFER, textures[unit].second);
    gl_.Uniform1i(at(textures[unit].first), static_cast<GLint>(unit));
  }
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.Uniform1i(at("item_count"), static_cast<GLint>(visible.items.size()));
  const VolumeLens lens = *volume_lens(view.lens, visible.items.front().camera_from_node);
  const glm::vec4 pixels(lens.pixels_x, lens.pixels_y, lens.width, lens.height);
  const glm::mat4& clip = view.projection.clip_from_camera;
  const glm::vec4 depths(std::max(view.lens.near_plane, range.nearest), clip[2][2], clip[3][2],
                         view.projection.reversed ? 0.0f : -1.0f);
  gl_.Uniform4fv(at("lens"), 1, glm::value_ptr(pixels));
  const glm::vec2 straight = -view.lens.center * glm::vec2(lens.pixels_x, lens.pixels_y);
  gl_.Uniform2f(at("straight"), straight.x, straight.y);
  gl_.Uniform4fv(at("depth_range"), 1, glm::value_ptr(depths));
  gl_.Uniform1f(at("farthest"), range.farthest);
  gl_.Uniform1f(at("gain"), range.gain);
  gl_.Uniform2i(at("ranks"), static_cast<GLint>(range.near_first ? visible.total - 1 - range.first : range.first),
                range.near_first ? -1 : 1);
  gl_.BindVertexArray(attributes_.name());
  gl_.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(range.count));
}

std::optional<PreparedSplats> VolumeGl::prepare(std::span<const SharedVolume> held, std::span<const VolumeItem> items,
                                                const View& view) {
  Visible visible;
  for (std::size_t i = 0; i < items.size(); ++i) {
    VolumeItem item = items[i];
    item.count = std::min({item.count, item.volume->size(), item.model->spacing.size()});
    if (item.count == 0 || !volume_lens(view.lens, item.camera_from_node)) continue;
    if (item.options.lights.size() > kMaxShaderLights) return std::nullopt;
    visible.held.push_back(held[i]);
    visible.items.push_back(item);
    visible.total += item.count;
  }
  if (visible.items.empty()) return PreparedSplats{};
  if (visible.total > kMaxVectors || !make_program_once()) return std::nullopt;
  GLint samples = 0;
  gl_.GetIntegerv(GL_SAMPLES, &samples);
  const VolumeSurvey survey = survey_volumes(visible.items, view.lens, kSurveyedVectors);
  if (survey.pixels * std::max(samples, 1) > kMaxBlendedSamples) return std::nullopt;
  PreparedSplats prepared{{survey.vectors, false}, 0, {}};
  if (survey.vectors == 0 && visible.total <= kSurveyedVectors) return prepared;
  take_errors(gl_);
  visible.places = store_.place(visible.held);
  if (visible.places.size() != visible.items.size() || !upload_items(visible, view.lens)) return std::nullopt;
  const auto order = sort(visible, view.viewport);
  if (!order) return std::nullopt;
  prepared.found.pending = order->pending;
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_BUFFER, order_texture_.name());
  gl_.TexBuffer(GL_TEXTURE_BUFFER, GL_R32UI, order->far_first.name());
  prepared.total = visible.total;
  prepared.draw = [this, visible = std::move(visible), view](const SplatRange& range) {
    draw_range(visible, view, range);
  };
  return prepared;
}

}  // namespace gs::render
