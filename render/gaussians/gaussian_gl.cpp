#include "render/gaussians/gaussian_gl.h"

#include "render/gaussians/gaussian_shaders.h"
#include "render/sorting/depth_sort_gl.h"
#include "render/sorting/depth_sort_shaders.h"
#include "render/sorting/item_texels.h"
#include "render/volume/volume_lens.h"

#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <variant>

namespace gs::render {
namespace {

constexpr std::size_t kGaussianItemTexels = 14;
constexpr std::size_t kMaxGaussians = std::size_t{1} << 28;
constexpr std::size_t kQuads = 64;  // splats per instance; more reduce the driver's work per instance
constexpr std::size_t kRectangleTexels = 3, kRectangleBytes = kRectangleTexels * sizeof(glm::vec4);
constexpr std::size_t kMaxRectangles = (std::size_t{1} << 29) / kRectangleBytes;  // if more, the vertex shader projects
constexpr std::size_t kProjectGroup = 128, kMaxProjectGroups = 65535;  // maximum groups that OpenGL 4.3 guarantees
// Splats from which the work is estimated, in blocks of successive ones.
constexpr std::size_t kSurveyedBlocks = 64, kSurveyedBlock = 32;
// Maximum pixels to blend. The CPU draws larger images, because it stops at opaque pixels. The system resets a driver
// that is busy for seconds.
constexpr double kMaxBlendedPixels = 2e10;

std::string gaussian_defines() {
  std::string text;
  const auto define = [&](const char* name, const std::string& value) {
    text += std::string("#define ") + name + " " + value + "\n";
  };
  define("ITEM_TEXELS", std::to_string(kGaussianItemTexels));
  define("QUADS", std::to_string(kQuads));
  define("LEAST_ALPHA", "(1.0 / 255.0)");
  define("LEAST_POWER", "-7.994353");
  define("MOST_ALPHA", "0.99");
  define("LOW_PASS", "0.3");
  define("FADE_GAIN", "2.8");
  define("MOST_REACH", "1e5");
  define("SURFEL_SCREEN", "2.0");
  static_assert(kGaussianLeastAlpha == 1 / 255.0f && kGaussianLeastPower == -7.994353f && kGaussianMostAlpha == 0.99f &&
                kGaussianLowPass == 0.3f && kGaussianMostReach == 1e5f && kGaussianFadeGain == 2.8f &&
                kSurfelScreen == 2);
  return text;
}

glm::vec3 eye_of(const GaussianItem& item) {
  return glm::inverse(glm::mat3(item.camera_from_node)) * -glm::vec3(item.camera_from_node[3]);
}

glm::mat3 metric_of(const GaussianItem& item) {
  const glm::mat3 linear(item.camera_from_node);
  return glm::transpose(linear) * linear;
}

/// Appends the texels of an item, in the layout of kGaussianItemShader. `start` is the number of its first splat.
void describe(const GaussianItem& item, const GaussianStore::Place& place, std::size_t start,
              std::vector<glm::vec4>& out) {
  const GaussianCoding& coding = place.coding;
  for (int i = 0; i < 3; ++i) out.push_back(matrix_row(item.camera_from_node, i));
  out.emplace_back(eye_of(item), item.opacity);
  const glm::mat3 metric = metric_of(item);
  out.emplace_back(metric[0], coding.scale.x);
  out.emplace_back(metric[1], coding.scale.y);
  out.emplace_back(metric[2], coding.base_limit);
  out.emplace_back(integer_halves(start), integer_halves(place.first + item.first * coding.texels));
  out.emplace_back(coding.texels, coding.degree, coding.harmonic_limit, item.gaussians->antialiased ? 1 : 0);
  out.push_back(item.clip.value_or(glm::vec4(0)));
  for (int i = 0; i < 3; ++i) {
    out.push_back(matrix_row(glm::mat4(item.fog.ranges_from_camera), i));
    out.back().w = item.fog.color[i];
  }
  out.emplace_back(!item.fog.on ? 0 : item.fog.exponential ? 2 : 1, item.fog.back, item.presence, 0);
}

/// Estimates for splats in a view, from a sample.
struct GaussianSurvey {
  double splats = 0;  // in view
  double pixels = 0;  // sum of the pixels that they cover
};

GaussianSurvey survey(std::span<const GaussianItem> items, const SplatView& view) {
  std::size_t total = 0, sampled = 0, before = 0;  // `before`: number of splats in earlier items
  for (const GaussianItem& item : items) total += item.count;
  const std::size_t blocks = std::min(kSurveyedBlocks, (total + kSurveyedBlock - 1) / kSurveyedBlock);
  ProjectedGaussians found;
  auto item = items.begin();
  for (std::size_t block = 0; block < blocks; ++block) {
    std::size_t at = block * (total / blocks);
    const std::size_t end =
        blocks < kSurveyedBlocks && block + 1 == blocks ? total : at + std::min(kSurveyedBlock, total / blocks);
    for (; item != items.end() && before + item->count <= at; ++item) before += item->count;
    std::size_t own = before;
    for (auto part = item; part != items.end() && at < end; own += part->count, ++part) {
      const std::size_t first = at - own, last = std::min(end - own, part->count);
      project_gaussians(*part, view, first, last, found);
      sampled += last - first;
      at = own + last;
    }
  }
  GaussianSurvey result;
  const double share = sampled > 0 ? static_cast<double>(total) / static_cast<double>(sampled) : 0;
  result.splats = share * static_cast<double>(found.splats.size());
  const auto width = static_cast<float>(view.width), height = static_cast<float>(view.height);
  for (const GaussianSplat& splat : found.splats) {
    const auto extent = [](float least, float most, float size) {
      return static_cast<double>(std::min(most, size) - std::max(least, 0.0f)) + 1;
    };
    result.pixels += share * extent(splat.left, splat.right, width) * extent(splat.bottom, splat.top, height);
  }
  return result;
}

}  // namespace

std::string gaussian_keys_shader() {
  return gaussian_defines() + kGaussianItemShader + kItemsShader + kGaussianKeysShader;
}

std::vector<glm::vec4> gaussian_item_texels(std::span<const GaussianItem> items,
                                            std::span<const GaussianStore::Place> places) {
  std::vector<glm::vec4> texels;
  std::size_t start = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    describe(items[i], places[i], start, texels);
    start += items[i].count;
  }
  return texels;
}

GaussianGl::GaussianGl(const Gl& gl, SortMethod sort)
    : gl_(gl),
      store_(gl),
      order_(gl, sort, gaussian_keys_shader()),
      attributes_(make_vertex_array(gl)),
      corners_(make_buffer(gl)),
      items_(make_texture(gl)),
      order_texture_(make_texture(gl)),
      rectangles_(make_texture(gl)) {
  gl_.BindVertexArray(attributes_.name());
  set_quad_elements(gl, corners_, kQuads);
  gl_.BindVertexArray(0);
}

/// Returns the program of a drawing. Compiles it on first use. It is empty if the driver rejects it.
const Program& GaussianGl::program(Drawing drawing) {
  const auto index = static_cast<std::size_t>(drawing);
  if (!tried_programs_[index]) {
    tried_programs_[index] = true;
    const std::string defines = (drawing == Drawing::project_surfels ? "#define SURFELS\n" : "") + gaussian_defines(),
                      vertex = drawing == Drawing::read_rectangles
                                   ? std::string(kGaussianReadShader)
                                   : std::string(kGaussianItemShader) + kItemsShader + kRankShader +
                                         kGaussianDataShader + kGaussianProjectionShader;
    auto made = make_program(gl_, defines, vertex + kGaussianVertexShader, kGaussianFragmentShader);
    if (auto* program = std::get_if<Program>(&made)) programs_[index] = std::move(*program);
  }
  return programs_[index];
}

bool GaussianGl::upload_items(std::span<const GaussianItem> items, std::span<const GaussianStore::Place> places) {
  GLint most = 0;
  gl_.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  const std::vector<glm::vec4> texels = gaussian_item_texels(items, places);
  std::size_t splats = 0;
  for (const GaussianItem& item : items) splats += item.count;
  // The order has a texel per splat.
  if (std::max(texels.size(), splats) > static_cast<std::size_t>(std::max(most, 0))) return false;
  return upload_item_texels(gl_, texels, item_buffer_, items_);
}

/// Selects a program, and sets its uniforms and textures. Skips those that the program lacks.
void GaussianGl::set_view(const Program& program, std::size_t items, const View& view, float nearest,
                          float farthest) const {
  gl_.UseProgram(program.name());
  const auto at = [&](const char* name) { return gl_.GetUniformLocation(program.name(), name); };
  const std::array<std::pair<const char*, GLuint>, 4> textures{{{"codes", store_.codes().name()},
                                                                {"items", items_.name()},
                                                                {"order", order_texture_.name()},
                                                                {"rectangles", rectangles_.name()}}};
  for (GLuint unit = 0; unit < textures.size(); ++unit) {
    const GLint place = at(textures[unit].first);
    if (place < 0) continue;
    gl_.ActiveTexture(GL_TEXTURE0 + unit);
    gl_.BindTexture(GL_TEXTURE_BUFFER, textures[unit].second);
    gl_.Uniform1i(place, static_cast<GLint>(unit));
  }
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.Uniform1i(at("item_count"), static_cast<GLint>(items));
  const SplatView& lens = view.lens;
  const auto width = static_cast<float>(lens.width), height = static_cast<float>(lens.height);
  const glm::vec2 pixels(width / (2 * lens.tangents.x), height / (2 * lens.tangents.y));
  const glm::vec4 pixels_size(pixels, width, height);
  const glm::vec2 reach = kGaussianFarthestTangent * lens.tangents;
  const glm::vec4 limits(lens.center - reach, lens.center + reach);
  const glm::mat4& clip = view.projection.clip_from_camera;
  const glm::vec4 depths(std::max(lens.near_plane, nearest), clip[2][2], clip[3][2],
                         view.projection.reversed ? 0.0f : -1.0f);
  gl_.Uniform4fv(at("lens"), 1, glm::value_ptr(pixels_size));
  gl_.Uniform4fv(at("limits"), 1, glm::value_ptr(limits));
  gl_.Uniform2f(at("straight"), -lens.center.x * pixels.x, -lens.center.y * pixels.y);
  gl_.Uniform4fv(at("depth_range"), 1, glm::value_ptr(depths));
  gl_.Uniform1f(at("farthest"), farthest);
}

/// Compiles the programs that make and read rectangles, on first use. Returns false if the driver rejects them, or if
/// there are too many splats.
bool GaussianGl::can_make_rectangles(std::size_t total) {
  GLint most = 0;
  gl_.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  if (total > kMaxRectangles || total > kMaxProjectGroups * kProjectGroup ||
      total > static_cast<std::size_t>(std::max(most, 0)) / kRectangleTexels)
    return false;
  if (!tried_project_) {
    tried_project_ = true;
    const PhaseScope phase(gl_.phases, Phase::compile);
    project_ = compute_program(gl_, "#version 430 core\n" + gaussian_defines() + kGaussianItemShader + kItemsShader +
                                        kRankShader + kGaussianDataShader + kGaussianProjectionShader +
                                        kGaussianRectanglesShader);
  }
  return project_ && program(Drawing::read_rectangles);
}

/// Projects all splats with a compute shader. Returns false if OpenGL reports an error, such as insufficient memory.
bool GaussianGl::make_rectangles(std::size_t items, std::size_t total, const View& view) {
  take_errors(gl_);
  if (total > rectangle_room_) {
    rectangle_room_ = 0;
    rectangle_buffer_ = make_buffer(gl_);
    const std::size_t room = std::min(total + total / 4, kMaxRectangles);
    gl_.BindBuffer(GL_TEXTURE_BUFFER, rectangle_buffer_.name());
    gl_.BufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(room * kRectangleBytes), nullptr, GL_DYNAMIC_COPY);
    gl_.ActiveTexture(GL_TEXTURE0);
    gl_.BindTexture(GL_TEXTURE_BUFFER, rectangles_.name());
    gl_.TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, rectangle_buffer_.name());
    if (take_errors(gl_)) return false;
    rectangle_room_ = room;
  }
  set_view(project_, items, view, 0, SplatRange{}.farthest);
  const auto at = [&](const char* name) { return gl_.GetUniformLocation(project_.name(), name); };
  gl_.Uniform1i(at("count"), static_cast<GLint>(total));
  gl_.Uniform2i(at("ranks"), 0, 1);
  gl_.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, rectangle_buffer_.name());
  gl_.DispatchCompute(static_cast<GLuint>((total + kProjectGroup - 1) / kProjectGroup), 1, 1);
  gl_.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  gl_.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, 0);
  return !take_errors(gl_);
}

void GaussianGl::draw_range(std::size_t items, std::size_t total, const View& view, const SplatRange& range) {
  const SplatRange all;
  const bool whole = range.nearest <= all.nearest && range.farthest >= all.farthest;
  if (whole && rectangle_state_ == Rectangles::wanted)
    rectangle_state_ = make_rectangles(items, total, view) ? Rectangles::made : Rectangles::impossible;
  const bool read = whole && rectangle_state_ == Rectangles::made;
  const Program& drawing = program(read       ? Drawing::read_rectangles
                                   : surfels_ ? Drawing::project_surfels
                                              : Drawing::project);
  if (!drawing) return;
  set_view(drawing, items, view, range.nearest, range.farthest);
  const auto at = [&](const char* name) { return gl_.GetUniformLocation(drawing.name(), name); };
  gl_.Uniform1i(at("count"), static_cast<GLint>(range.count));
  gl_.Uniform2i(at("ranks"), static_cast<GLint>(range.near_first ? total - 1 - range.first : range.first),
                range.near_first ? -1 : 1);
  gl_.Uniform1f(at("gain"), range.gain);
  gl_.BindVertexArray(attributes_.name());
  gl_.DrawElementsInstancedBaseVertex(GL_TRIANGLES, static_cast<GLsizei>(6 * kQuads), GL_UNSIGNED_SHORT, nullptr,
                                      static_cast<GLsizei>((range.count + kQuads - 1) / kQuads), 0);
  gl_.BindVertexArray(0);
}

std::optional<PreparedSplats> GaussianGl::prepare(std::span<const std::shared_ptr<const qnv::Gaussians>> held,
                                                  std::span<const GaussianItem> items, const View& view) {
  std::vector<std::shared_ptr<const qnv::Gaussians>> scenes;
  std::vector<GaussianItem> visible;
  std::vector<SortPart> parts;
  std::size_t total = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    GaussianItem item = items[i];
    item.first = std::min(item.first, held[i]->size());
    item.count = std::min(item.count, held[i]->size() - item.first);
    if (item.count == 0 || !volume_lens(view.lens, item.camera_from_node)) continue;
    SortPart part;
    part.vectors = held[i];
    part.first = item.first;
    part.count = item.count;
    part.by_distance = true;
    part.eye = eye_of(item);
    part.metric = metric_of(item);
    scenes.push_back(held[i]);
    visible.push_back(item);
    parts.push_back(std::move(part));
    total += item.count;
  }
  if (visible.empty()) return PreparedSplats{};
  if (total > kMaxGaussians) return std::nullopt;
  const GaussianSurvey found = survey(visible, view.lens);
  if (found.pixels > kMaxBlendedPixels) return std::nullopt;
  take_errors(gl_);
  const std::vector<GaussianStore::Place> places = store_.place(scenes);
  if (places.size() != scenes.size() || !upload_items(visible, places)) return std::nullopt;
  surfels_ = std::ranges::any_of(places, [](const auto& place) { return place.coding.surfels; });
  const auto order =
      order_.order(view.viewport, parts, {store_.codes().name(), items_.name(), static_cast<int>(visible.size())});
  if (!order) return std::nullopt;
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_BUFFER, order_texture_.name());
  gl_.TexBuffer(GL_TEXTURE_BUFFER, GL_R32UI, order->far_first.name());
  if (take_errors(gl_)) return std::nullopt;
  const bool computes = order_.sorted_by() == SortMethod::compute && !surfels_ && can_make_rectangles(total);
  rectangle_state_ = computes ? Rectangles::wanted : Rectangles::impossible;
  if (!computes && !program(surfels_ ? Drawing::project_surfels : Drawing::project)) return std::nullopt;
  return PreparedSplats{
      {static_cast<std::size_t>(found.splats + 0.5), order->pending},
      total,
      [this, count = visible.size(), total, view](const SplatRange& range) { draw_range(count, total, view, range); }};
}

}  // namespace gs::render
