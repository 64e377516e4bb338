#include "render/splat/splat_gl.h"
#include "render/splat/splat_closing.h"
#include "tests/render/drawing.h"
#include "tests/render/splat_scenes.h"

#include <limits>
#include <random>

using namespace gs;
using namespace gs::render;
using namespace gs::render::testing;

namespace {

RenderList sphere_list(const std::shared_ptr<const qnv::Splats>& geometry,
                       const glm::mat4& world_from_node = glm::mat4(1.0f)) {
  RenderList list;
  SplatItem item;
  item.geometry = shared_geometry(geometry);
  item.world_from_node = world_from_node;
  item.material.specular = glm::vec3(0.3f);
  for (int i = 0; i < 8; ++i)
    list.bounds.add(glm::vec3(world_from_node * glm::vec4(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1, 1)));
  list.splats.push_back(std::move(item));
  return list;
}

double mean_square(const Image& a, const Image& b) {
  REQUIRE(a.pixels.size() == b.pixels.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const double difference = double{static_cast<double>(a.pixels[i])} - double{static_cast<double>(b.pixels[i])};
    sum += difference * difference;
  }
  return sum / static_cast<double>(a.pixels.size());
}

/// Reports whether OpenGL found no error since the last call.
bool faultless(GlContext& context) {
  auto gl = Gl::load(context);
  return !take_errors(std::get<Gl>(gl));
}

/// Compares OpenGL with the processor, at one and four samples per pixel. The item must be visible.
void check_same_picture(const RenderList& list, const Camera& camera) {
  static Drawing drawing;
  for (const int samples : {1, 4}) {
    drawing.options.width = 160;
    drawing.options.height = 120;
    drawing.options.samples = samples;
    drawing.options.splats = SplatPath::cpu;
    const Image wanted = drawing.draw(list, camera);
    CHECK(drawing.statistics.splats == std::string("cpu"));
    drawing.options.splats = SplatPath::gl;
    const Image drawn = drawing.draw(list, camera);
    CHECK(drawing.statistics.splats == std::string("gl"));
    CHECK(drawing.statistics.vectors > 0);
    CHECK(faultless(drawing.context()));
    RenderList nothing = list;
    nothing.splats.clear();
    CHECK(mean_square(wanted, drawing.draw(nothing, camera)) > 100);
    const double psnr = 10 * std::log10(255.0 * 255.0 / std::max(mean_square(drawn, wanted), 1e-9));
    INFO("samples " << samples << ", PSNR " << psnr);
    CHECK(psnr >= 35);
  }
}

/// Returns a view from 3 radii, which the sphere fills.
SplatView view_of_sphere() {
  SplatView view;
  view.camera_from_node = translation({0, 0, -3});
  view.tangents = {0.5f, 0.4f};
  view.width = 100;
  view.height = 80;
  view.near_plane = 0.1f;
  return view;
}

// Differences of two layers, as shares of the pixels.
struct LayerDifference {
  double uncovered = 0;  // covered in only one of the two layers
  double wrong = 0;      // of both covered: normal off by over 2 degrees, depth by 1/1000, or colour by 3
  std::size_t both = 0;
};

LayerDifference compare(const SplatLayer& a, const SplatLayer& b) {
  LayerDifference result;
  REQUIRE(a.depth.size() == b.depth.size());
  REQUIRE(a.colors.size() == b.colors.size());
  const auto normal = [](const SplatLayer& layer, std::size_t i) {
    const auto c = [&](std::size_t axis) { return static_cast<float>(layer.normals[4 * i + axis]) / 32767.5f - 1; };
    return glm::normalize(glm::vec3(c(0), c(1), c(2)));
  };
  for (std::size_t i = 0; i < a.depth.size(); ++i) {
    const bool in_a = a.normals[4 * i + 3] != 0, in_b = b.normals[4 * i + 3] != 0;
    result.uncovered += in_a != in_b ? 1 : 0;
    if (!in_a || !in_b) continue;
    ++result.both;
    bool wrong = glm::dot(normal(a, i), normal(b, i)) < std::cos(2 * kPi / 180);
    wrong = wrong || std::abs(a.depth[i] - b.depth[i]) > 1e-3f * b.depth[i];
    for (std::size_t c = 0; c < 3 && !a.colors.empty(); ++c)
      wrong = wrong || std::abs(int{a.colors[4 * i + c]} - int{b.colors[4 * i + c]}) > 3;
    result.wrong += wrong ? 1 : 0;
  }
  result.uncovered /= static_cast<double>(a.depth.size());
  result.wrong /= static_cast<double>(std::max<std::size_t>(result.both, 1));
  return result;
}

}  // namespace

TEST_CASE("draws surfaces of splats with OpenGL as on the processor", "[optimised]") {
  check_same_picture(sphere_list(sphere(3000)), camera_at({0, 0, 3.5f}));
  // The splats are wide, with interpolated normals between them.
  check_same_picture(sphere_list(sphere(300)), camera_at({0, 0, 3.5f}));
  // The splats are smaller than a sample.
  check_same_picture(sphere_list(sphere(100000)), camera_at({0, 0, 8}));
  check_same_picture(sphere_list(sphere(3000, true)), camera_at({0.5f, 0.3f, 3.5f}));
  check_same_picture(sphere_list(sphere(300, true)), camera_at({0, 0, 3.5f}));
}

TEST_CASE("draws octree splats with OpenGL as on the processor", "[optimised]") {
  const auto coarse = octree_sphere(500), fine = octree_sphere(8000);
  REQUIRE(!fine->cells.empty());
  check_same_picture(sphere_list(coarse), camera_at({0, 0, 3.5f}));
  check_same_picture(sphere_list(fine), camera_at({0, 0.2f, 3.5f}));
}

TEST_CASE("keeps the sides of two-sided surfaces apart with OpenGL", "[optimised]") {
  auto geometry = sphere(3000, true);
  geometry->description.two_sided = true;
  check_same_picture(sphere_list(geometry), camera_at({0, 0, 3.5f}));
  check_same_picture(sphere_list(geometry), camera_at({0, 0, 0}));  // from inside
  auto cells = std::make_shared<qnv::Splats>(*octree_sphere(4000));
  cells->description.two_sided = true;
  check_same_picture(sphere_list(cells), camera_at({0, 0, 0}));
}

TEST_CASE("draws surfaces with OpenGL under any scale, and partly behind the viewer", "[optimised]") {
  const glm::mat4 turn(glm::vec4(0.8f, 0.6f, 0, 0), glm::vec4(-0.6f, 0.8f, 0, 0), glm::vec4(0, 0, 1, 0),
                       glm::vec4(0, 0, 0, 1));
  check_same_picture(sphere_list(sphere(3000), turn * scale({1.5f, 0.5f, 0.8f})), camera_at({0, 0, 4}));
  check_same_picture(sphere_list(octree_sphere(4000), turn * scale({1.5f, 0.5f, 0.8f})), camera_at({0, 0, 4}));
  // The item is sheared: rotated, then scaled.
  const glm::mat4 shear = scale({2, 0.5f, 1}) * turn;
  check_same_picture(sphere_list(sphere(300), shear), camera_at({0, 0, 4}));
  check_same_picture(sphere_list(octree_sphere(4000), shear), camera_at({0, 0, 4}));
  check_same_picture(sphere_list(sphere(2000), scale({-1, 1, 1})), camera_at({0, 0, 4}));
  check_same_picture(sphere_list(sphere(2000), scale(glm::vec3(1e-4f))), camera_at({0, 0, 4e-4f}));
  auto geometry = sphere(3000);
  geometry->description.two_sided = true;
  check_same_picture(sphere_list(geometry), camera_at({0, 0, 1.01f}));
  check_same_picture(sphere_list(geometry), camera_at({0.9f, 0, 0.3f}));
}

TEST_CASE("hides splats and meshes behind each other with OpenGL") {
  RenderList list = sphere_list(sphere(2000));
  add(list, glowing(square(0.5f), {1, 0, 0}, translation({0, 0, 1.2f})));
  add(list, glowing(square(0.5f), {0, 1, 0}, translation({0.5f, 0, 0})));
  check_same_picture(list, camera_at({0, 0, 4}));
}

TEST_CASE("draws splats on the processor if OpenGL is a software path") {
  const bool software = OpenContext().gl.software;
  Drawing drawing;
  (void)drawing.draw(sphere_list(sphere(100)));
  CHECK(drawing.statistics.splats == std::string(software ? "cpu" : "gl"));
  drawing.options.splats = SplatPath::gl;
  (void)drawing.draw(sphere_list(sphere(100)));
  CHECK(drawing.statistics.splats == std::string("gl"));
  RenderList list = sphere_list(sphere(100));
  list.splats.clear();
  (void)drawing.draw(list);
  CHECK(drawing.statistics.splats == std::string("none"));
}

TEST_CASE("draws tints and normals as colours with OpenGL") {
  OpenContext open;
  SplatGl splats(open.gl);
  SplatView view = view_of_sphere();
  const auto plain = sphere(4000), colored = sphere(4000, true);
  // The first splats of the sphere, with normal +Z, cover its middle.
  const auto middle = [&](const std::vector<SharedSplatPiece>& pieces) {
    const auto drawn = splats.draw(pieces, view);
    REQUIRE(drawn);
    const SplatLayer layer = splats.read(*drawn, view);
    REQUIRE(!layer.colors.empty());
    const std::size_t at = 4 * (40 * 100 + 50);
    return glm::vec3(layer.colors[at], layer.colors[at + 1], layer.colors[at + 2]);
  };
  const qnv::Rgb8 red{250, 10, 20}, green{0, 200, 1};
  check_color(middle({{plain, 0, 4000, 1, red}}), glm::vec3(250, 10, 20) / 255.0f);
  check_color(middle({{colored, 0, 4000, 1, red}}), glm::vec3(250, 10, 20) / 255.0f);
  check_color(middle({{plain, 0, 2000, 1, green}, {colored, 2000, 2000, 1, red}}), glm::vec3(0, 200, 1) / 255.0f);
  // Pieces without a tint keep the colour of their splats.
  check_color(middle({{plain, 0, 2000}, {colored, 2000, 2000, 1, red}}), glm::vec3(0.8f));
  view.color_by_normal = true;
  check_color(middle({{colored, 0, 4000, 1, red}}), {0.5f, 0.5f, 1}, 4);
}

TEST_CASE("draws thousands of splat items with a few calls") {
  OpenContext open;
  SplatGl splats(open.gl);
  const auto whole = sphere(40000);
  std::vector<SharedSplatPiece> pieces;
  for (std::size_t first = 0; first < whole->size(); first += 20) {
    auto part = std::make_shared<qnv::Splats>();
    const auto take = [&](const auto& from, auto& to) {
      to.assign(from.begin() + static_cast<std::ptrdiff_t>(first),
                from.begin() + static_cast<std::ptrdiff_t>(first) + 20);
    };
    take(whole->positions, part->positions);
    take(whole->normals, part->normals);
    take(whole->weights, part->weights);
    pieces.push_back({part, 0, 20});
  }
  REQUIRE(pieces.size() == 2000);
  const SplatView view = view_of_sphere();
  const auto drawn = splats.draw(pieces, view);
  REQUIRE(drawn);
  CHECK(drawn->draw_calls == 3);
  CHECK(splats.store().slabs() == 1);
  const LayerDifference difference = compare(splats.read(*drawn, view), rasterize_surface(*whole, view));
  CHECK(difference.both > 3000);
  CHECK(difference.uncovered < 0.005);
  CHECK(difference.wrong < 0.01);
  CHECK(!take_errors(open.gl));
  // Pieces without an owner are freed.
  pieces.clear();
  splats.forget_unused();
  CHECK(splats.store().reserved_bytes() == 0);
}

TEST_CASE("closes pinholes, but no real openings") {
  SplatLayer layer;
  SplatView view;
  view.width = layer.width = 9;
  view.height = layer.height = 7;
  const auto covered = [&](int x, int y) -> std::uint16_t& {
    return layer.normals[4 * static_cast<std::size_t>(y * 9 + x) + 3];
  };
  layer.depth.assign(63, 5);
  layer.normals.assign(4 * 63, 65535);
  covered(4, 3) = 0;
  covered(5, 3) = 0;
  covered(2, 2) = 16383;
  covered(8, 5) = 0;  // at the edge of the picture
  layer.depth[3 * 9 + 4] = layer.depth[3 * 9 + 5] = 0;
  SplatLayer closed = layer;
  close_pinholes(closed, view, 2);
  CHECK(*std::min_element(closed.normals.begin(), closed.normals.end()) > 30000);
  CHECK(std::all_of(closed.depth.begin(), closed.depth.end(), [](float depth) { return depth == 5; }));
  // The hole is too wide, open at one side, or in a layer that ends before the picture.
  closed = layer;
  close_pinholes(closed, view, 1);
  CHECK(closed.normals[4 * (3 * 9 + 4) + 3] == 0);
  closed = layer;
  for (int y = 0; y < 7; ++y) closed.normals[4 * static_cast<std::size_t>(y * 9 + 4) + 3] = 0;
  close_pinholes(closed, view, 2);
  CHECK(closed.normals[4 * (3 * 9 + 4) + 3] == 0);
  closed = layer;
  view.width = 20;
  close_pinholes(closed, view, 2);
  CHECK(closed.normals[4 * (5 * 9 + 8) + 3] == 0);
}

TEST_CASE("draws pictures too large for OpenGL on the processor") {
  OpenContext open;
  SplatGl splats(open.gl);
  const auto geometry = sphere(100);
  const SharedSplatPiece whole{geometry, 0, 100};
  SplatView view = view_of_sphere();
  view.width = open.gl.max_texture_size + 1;
  CHECK(!splats.draw(std::span(&whole, 1), view));
  view.width = view.height = std::min(open.gl.max_texture_size, 16384);
  CHECK(!splats.draw(std::span(&whole, 1), view));
  // Four samples exceed the maximum size, one does not.
  view.width = open.gl.max_texture_size;
  view.height = 8;
  view.supersample = 2;
  const auto drawn = splats.draw(std::span(&whole, 1), view);
  REQUIRE(drawn);
  CHECK(drawn->normals != 0);
  CHECK(!take_errors(open.gl));
}

TEST_CASE("joins pieces of splats to one surface") {
  OpenContext open;
  SplatGl splats(open.gl);
  const auto whole = sphere(4000), other = sphere(4000, true);
  const std::array<SharedSplatPiece, 3> pieces{{{whole, 0, 1000, 1.5f}, {other, 1000, 1500}, {whole, 2500, 1500}}};
  const std::array<SplatPiece, 3> same{
      {{whole.get(), 0, 1000, 1.5f}, {other.get(), 1000, 1500}, {whole.get(), 2500, 1500}}};
  SplatView view = view_of_sphere();
  const auto drawn = splats.draw(pieces, view);
  REQUIRE(drawn);
  const LayerDifference difference = compare(splats.read(*drawn, view), rasterize_surface(same, view));
  CHECK(difference.both > 3000);
  CHECK(difference.uncovered < 0.005);
  CHECK(difference.wrong < 0.01);
  // A piece beyond the end of the splats is skipped.
  const std::array<SharedSplatPiece, 2> hostile{
      {{whole, 3999, 2}, {whole, std::numeric_limits<std::size_t>::max(), 2}}};
  const auto nothing = splats.draw(hostile, view);
  REQUIRE(nothing);
  CHECK(nothing->normals == 0);
}

TEST_CASE("survives splats with NaN, infinite and extreme values") {
  Drawing drawing;
  drawing.options.width = drawing.options.height = 24;
  drawing.options.splats = SplatPath::gl;
  constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNone = std::numeric_limits<float>::quiet_NaN(),
                  kMax = std::numeric_limits<float>::max(), kMin = std::numeric_limits<float>::denorm_min();
  const std::array<float, 10> numbers{0, 1, -1, kInfinity, -kInfinity, kNone, kMax, -kMax, kMin, 1e-20f};
  std::mt19937 random(9);
  const auto any = [&] { return numbers[random() % numbers.size()]; };
  for (int round = 0; round < 60; ++round) {
    auto geometry = std::make_shared<qnv::Splats>();
    geometry->description.two_sided = round % 2 == 0;
    geometry->description.box = {{-1, -1, -1}, {1, 1, 1}};
    for (int i = 0; i < 1 + round; ++i) {
      // Some rounds have only finite positions, so that something is drawn.
      geometry->positions.push_back(round % 3 == 0 ? glm::vec3(0.1f * static_cast<float>(i % 9), 0, 0)
                                                   : glm::vec3(any(), any(), any()));
      geometry->normals.push_back({any(), any(), any()});
      geometry->weights.push_back(any());
      if (round % 4 == 1) geometry->cells.push_back({any(), any()});
      if (round % 5 == 1) geometry->colors.push_back({1, 2, 3});
    }
    (void)drawing.draw(sphere_list(geometry));
    CHECK(drawing.statistics.splats != std::string("none"));
    CHECK(faultless(drawing.context()));
  }
  // Arrays of different lengths are not drawn.
  auto torn = sphere(100);
  torn->weights.resize(50);
  for (const SplatPath path : {SplatPath::gl, SplatPath::cpu}) {
    drawing.options.splats = path;
    (void)drawing.draw(sphere_list(torn));
    CHECK(drawing.statistics.vectors == 0);
  }
  drawing.options.splats = SplatPath::gl;
  (void)drawing.draw(sphere_list(sphere(10), scale({1, 1, 0})));
  (void)drawing.draw(sphere_list(sphere(10), scale(glm::vec3(kNone))));
  (void)drawing.draw(sphere_list(std::make_shared<qnv::Splats>()));
}
