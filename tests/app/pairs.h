// Comparison of small pictures of two worlds, pixel by pixel.
#pragma once

#include "app/loading/world_loading.h"
#include "render/collection/shapes/shape_resources.h"
#include "render/scene/camera.h"
#include "tests/app/formats_helpers.h"
#include "tests/net/memory_network.h"
#include "tests/render/drawing.h"
#include "tests/vrml/encodings.h"
#include "tests/vrml/vrml1_text.h"
#include "vrml/mesh/mesh.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::app::pairs {

/// Returns the exact text of a number in a world.
inline std::string number(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.9g ", value);
  return text.data();
}

/// Contents of files by name. The studio shows "main.wrl".
using Files = std::map<std::string, std::string>;

/// Studio that draws worlds of 64 x 64 pixels from their first Viewpoint.
class Studio {
 public:
  /// Draws the worlds in an encoding. Their names stay, because the content determines the encoding.
  [[nodiscard]] render::Image picture(const Files& files, vrml::Grammar grammar = vrml::Grammar::vrml97) {
    auto network = std::make_shared<net::MemoryNetwork>();
    LoadOptions options;
    options.memory = net::MakeMemoryTransport{network};
    for (const auto& [name, text] : files) {
      net::MemoryResource resource;
      const bool world = name.ends_with(".wrl");
      const std::string vrml97 = "#VRML V2.0 utf8\n" + text;
      if (world && text.starts_with('#'))
        resource.bytes = gs::test::bytes_of(text);
      else if (world && grammar != vrml::Grammar::vrml97)
        resource.bytes = gs::test::bytes_of(vrml::testing::encoded(vrml97, grammar));
      else
        resource.bytes = gs::test::bytes_of(world ? vrml97 : text);
      network->put("memory://a/" + name, std::move(resource));
    }
    WorldLoading loading("memory://a/main.wrl", options);
    while (!loading.done()) (void)loading.step(std::chrono::milliseconds(50));
    render::Camera camera = render::testing::camera_at({0, 0, 10});
    render::RenderList list = loading.collect({0, 0, 10});
    if (!list.viewpoints.empty()) {
      camera.world_from_camera = list.viewpoints.front().world_from_camera;
      camera.field_of_view = list.viewpoints.front().field_of_view;
      list = loading.collect(glm::vec3(camera.world_from_camera[3]));  // collects the parts that depend on the viewer's
                                                                       // position
    }
    drawing_.options.headlight = list.navigation.headlight && !dark_;
    const LoadedWorld world = loading.take();
    for (const auto& diagnostic : world.diagnostics.entries()) FAIL(diagnostic.text());
    return drawing_.draw(list, camera);
  }
  [[nodiscard]] render::Image picture(const std::string& text) { return picture(Files{{"main.wrl", text}}); }
  /// Draws worlds in VRML 1.0, which cannot switch the headlight off. `dark` does so.
  [[nodiscard]] render::Image old_picture(const Files& files, bool dark) {
    dark_ = dark;
    ++old_worlds_;
    render::Image image = picture(files);
    dark_ = false;
    return image;
  }

  /// Returns the number of worlds that were drawn in VRML 1.0.
  [[nodiscard]] std::size_t old_worlds() const { return old_worlds_; }

 private:
  std::size_t old_worlds_ = 0;
  bool dark_ = false;  // draws without the headlight
  render::testing::Drawing drawing_;
};

struct PictureDifference {
  std::size_t pixels = 0;  // pixels that differ by more than rounding
  int most = 0;            // of 255
};
inline PictureDifference compare_pictures(const render::Image& a, const render::Image& b, int rounding = 2) {
  REQUIRE(a.pixels.size() == b.pixels.size());
  PictureDifference difference;
  for (std::size_t pixel = 0; pixel < a.pixels.size(); pixel += a.components) {
    int most = 0;
    for (std::size_t i = pixel; i < pixel + a.components; ++i)
      most = std::max(most, std::abs(int{a.pixels[i]} - int{b.pixels[i]}));
    difference.pixels += most > rounding;
    difference.most = std::max(difference.most, most);
  }
  return difference;
}

/// Counts pixels that are not black, the colour of an empty world.
inline std::size_t shown_pixels(const render::Image& image) {
  std::size_t count = 0;
  for (std::size_t pixel = 0; pixel < image.pixels.size(); pixel += image.components)
    count += image.pixels[pixel] + image.pixels[pixel + 1] + image.pixels[pixel + 2] > 0;
  return count;
}

/// Returns an IndexedFaceSet with the triangles, normals and texture coordinates of a mesh.
inline std::string faces_of(const vrml::Mesh& mesh) {
  std::string text =
      "IndexedFaceSet { solid " + std::string(mesh.solid ? "TRUE" : "FALSE") + " coord Coordinate { point [ ";
  for (const glm::vec3& p : mesh.positions) text += number(p.x) + number(p.y) + number(p.z);
  text += "] } normal Normal { vector [ ";
  for (const glm::vec3& n : mesh.normals) text += number(n.x) + number(n.y) + number(n.z);
  text += "] } texCoord TextureCoordinate { point [ ";
  for (const glm::vec2& t : mesh.texture_coordinates) text += number(t.x) + number(t.y);
  text += "] } coordIndex [ ";
  for (std::size_t i = 0; i < mesh.indices.size(); ++i)
    text += std::to_string(mesh.indices[i]) + (i % 3 == 2 ? " -1 " : " ");
  return text + "] }";
}

/// Checks that a world has the same picture in each encoding of X3D.
inline void check_encodings(Studio& studio, const Files& files, const render::Image& picture) {
  for (const vrml::Grammar grammar : vrml::testing::kX3DGrammars) {
    INFO(vrml::testing::name_of(grammar));
    CHECK(compare_pictures(picture, studio.picture(files, grammar), 0).pixels == 0);
  }
}

/// Returns worlds without the ambient intensity of lights, which VRML 1.0 lacks.
inline Files without_ambient_lights(Files files) {
  const std::string ambient = " ambientIntensity 0.4 }";
  for (auto& [name, text] : files)
    for (std::size_t at = text.find(ambient); at != std::string::npos; at = text.find(ambient, at))
      text.replace(at, ambient.size(), " }");
  return files;
}

/// Checks that a world has the same picture in VRML 1.0 if it can be expressed there. Returns false if it cannot.
inline bool check_vrml1(Studio& studio, const Files& given, std::size_t edge_pixels) {
  const Files files = without_ambient_lights(given);
  Files old = files;
  for (auto& [name, text] : old) {
    if (!name.ends_with(".wrl")) continue;
    const std::optional<std::string> written = vrml::testing::Vrml1Writer::write("#VRML V2.0 utf8\n" + text);
    if (!written) return false;
    text = *written;
  }
  INFO(old["main.wrl"]);
  const bool dark = files.at("main.wrl").find("headlight FALSE") != std::string::npos;
  const PictureDifference difference = compare_pictures(studio.picture(files), studio.old_picture(old, dark));
  INFO("VRML 1.0 differs by up to " << difference.most);
  CHECK(difference.pixels <= edge_pixels);
  return true;
}

/// Checks that two worlds look alike except for some pixels at edges, where rounding decides. Checks the first one in
/// each encoding of X3D, too.
inline void check_alike(Studio& studio, const std::string& what, const Files& a, const Files& b,
                        std::size_t edge_pixels = 12) {
  INFO(what);
  const render::Image first = studio.picture(a), second = studio.picture(b);
  CHECK(shown_pixels(first) > 120);
  const PictureDifference difference = compare_pictures(first, second);
  INFO("differ by up to " << difference.most);
  CHECK(difference.pixels <= edge_pixels);
  check_encodings(studio, a, first);
  constexpr std::size_t kEdgePixels = 12;
  for (const Files* const files : {&a, &b}) (void)check_vrml1(studio, *files, std::max(edge_pixels, kEdgePixels));
}
inline void check_alike(Studio& studio, const std::string& what, const std::string& a, const std::string& b,
                        std::size_t edge_pixels = 12) {
  check_alike(studio, what, Files{{"main.wrl", a}}, Files{{"main.wrl", b}}, edge_pixels);
}

}  // namespace gs::app::pairs
