#include "app/formats/export/export.h"
#include "base/text.h"
#include "qnv/base/shine.h"

#include <array>
#include <charconv>
#include <string>
#include <string_view>
#include <utility>

namespace gs::app {
namespace {

/// Text of numbers in their shortest form that reads back the same.
class ObjText {
 public:
  ObjText& word(std::string_view text) {
    text_ += text;
    return *this;
  }
  template <class Number>
  ObjText& number(Number value) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value);
    text_ += ' ';
    text_.append(digits.data(), end.ptr);
    return *this;
  }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

float unit(std::uint8_t component) { return static_cast<float>(component) / 255; }

std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return text;
}

/// Returns the materials of a mesh: "plain", and "textured" if it has a texture.
std::string materials_of(const qnv::IndexedMesh& mesh, const std::string& image) {
  ObjText text;
  const qnv::Shine shine = qnv::shine_of(mesh.description);
  for (const bool textured : {false, true}) {
    if (textured && image.empty()) continue;
    const qnv::Rgb8 color = textured || !mesh.colors.empty() ? qnv::Rgb8{255, 255, 255} : mesh.color;
    text.word(textured ? "\nnewmtl textured\nKd" : "# GhostSpace\nnewmtl plain\nKd");
    text.number(unit(color.r)).number(unit(color.g)).number(unit(color.b)).word("\nKs");
    for (int k = 0; k < 3; ++k) text.number(shine.specular[k]);
    text.word("\nNs").number(shine.shininess * 128).word("\n");
    if (textured) {
      text.word("map_Kd ");
      if (mesh.picture && !(mesh.picture->repeat_s && mesh.picture->repeat_t)) text.word("-clamp on ");
      text.word(image).word("\n");
    }
  }
  return text.take();
}

}  // namespace

Exported export_obj(const qnv::Geometry& geometry, const ExportOptions& options) {
  const auto* mesh = geometry.as<qnv::IndexedMesh>();
  if (!mesh || mesh->triangles.empty()) return std::string(kNoTriangles);
  const std::size_t border = mesh->first_textured();
  const bool textured = options.beside && mesh->picture && border < mesh->size();
  ObjText text;
  text.word("# GhostSpace\n");
  if (options.beside) text.word("mtllib " + options.name + ".mtl\n");
  if (!options.title.empty()) text.word("o " + one_line(options.title) + "\n");
  const glm::dvec3& origin = mesh->description.origin;
  for (std::size_t i = 0; i < mesh->size(); ++i) {
    text.word("v");
    for (int k = 0; k < 3; ++k) {
      if (origin == glm::dvec3(0))
        text.number(mesh->positions[i][k]);
      else
        text.number(origin[k] + static_cast<double>(mesh->positions[i][k]));
    }
    if (!mesh->colors.empty())
      text.number(unit(mesh->colors[i].r)).number(unit(mesh->colors[i].g)).number(unit(mesh->colors[i].b));
    text.word("\n");
  }
  for (const glm::vec2& at : mesh->texture_coordinates) text.word("vt").number(at.x).number(at.y).word("\n");
  for (const glm::vec3& normal : mesh->normals)
    text.word("vn").number(normal.x).number(normal.y).number(normal.z).word("\n");
  for (const bool with_texture : {false, true}) {
    bool begun = false;
    for (std::size_t i = 0; i + 2 < mesh->triangles.size(); i += 3) {
      if ((mesh->triangles[i] >= border) != with_texture) continue;
      if (!std::exchange(begun, true) && options.beside)
        text.word(with_texture && textured ? "usemtl textured\n" : "usemtl plain\n");
      text.word("f");
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t v = mesh->triangles[i + k];
        text.number(v + 1).word("/");
        if (with_texture) text.word(std::to_string(v - border + 1));
        text.word("/" + std::to_string(v + 1));
      }
      text.word("\n");
    }
  }
  if (options.beside) {
    std::string image;
    if (textured) {
      const std::vector<std::byte>& file = mesh->picture->bytes;
      image = options.name + (!file.empty() && file[0] == std::byte{0x89} ? ".png" : ".jpg");
      options.beside->push_back({image, file});
    }
    options.beside->push_back({options.name + ".mtl", copied_bytes(materials_of(*mesh, image))});
  }
  return copied_bytes(text.take());
}

}  // namespace gs::app
