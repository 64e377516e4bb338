#include "app/formats/gltf/gltf_splats.h"

#include "app/formats/gltf/gltf_accessor.h"
#include "app/formats/gltf/gltf_load.h"
#include "app/formats/gltf/gltf_placement.h"
#include "app/formats/splats/splat_axes.h"
#include "app/formats/splats/splat_transform.h"
#include "app/formats/splats/splats.h"

#include <glm/mat4x4.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {
namespace {

const std::string& prefix() {
  static const std::string text = std::string(kSplatExtension) + ":";
  return text;
}

int splat_attribute(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

std::string harmonic_name(int degree, int number) {
  return prefix() + "SH_DEGREE_" + std::to_string(degree) + "_COEF_" + std::to_string(number);
}

/// Reader of the splats of one asset.
class SplatReader {
 public:
  SplatReader(const tinygltf::Model& model, SceneBuilder& builder)
      : model_(model), builder_(builder), accessors_(model, builder.scene()) {
    splats_.format = "glTF KHR_gaussian_splatting";
    splats_.axes = kFromRightUpBack;
  }

  [[nodiscard]] const SplatModel& read() {
    find_places();
    int degree = 0;
    for (const Place& place : places_)
      degree = std::max(degree, place.spz ? spz_of(place).harmonics : degree_of(*place.primitive));
    splats_.set_degree(degree);
    for (const Place& place : places_)
      if (place.spz)
        add_spz(place);
      else
        add(place);
    if (others_ > 0)
      builder_.warn(std::to_string(others_) + " meshes beside the splats are left out; expected splats only");
    return splats_;
  }

 private:
  struct Place {
    const tinygltf::Primitive* primitive;
    glm::mat4 world;
    std::optional<int> spz;  // buffer view with the splats as SPZ
  };

  /// Finds the primitives of splats, each with the transformation of its node. Visits each node once.
  void find_places() {
    std::vector<std::pair<int, glm::mat4>> open;
    std::vector<bool> seen(model_.nodes.size());
    for (const int root : scene_roots(model_)) open.emplace_back(root, glm::mat4(1));
    while (!open.empty()) {
      const auto [index, outer] = open.back();
      open.pop_back();
      if (!exists(model_, index) || seen[static_cast<std::size_t>(index)]) continue;
      seen[static_cast<std::size_t>(index)] = true;
      const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
      const glm::mat4 world = outer * placement_of(node).matrix();
      for (const int child : node.children) open.emplace_back(child, world);
      if (node.mesh < 0 || static_cast<std::size_t>(node.mesh) >= model_.meshes.size()) continue;
      for (const tinygltf::Primitive& primitive : model_.meshes[static_cast<std::size_t>(node.mesh)].primitives)
        if (primitive.extensions.contains(kSplatExtension) || primitive.extensions.contains(kFormerSpzExtension))
          places_.push_back({&primitive, world, spz_view(primitive)});
        else
          ++others_;
    }
  }

  /// Returns the buffer view of splats in SPZ, or nullopt for a primitive without SPZ.
  [[nodiscard]] static std::optional<int> spz_view(const tinygltf::Primitive& primitive) {
    const auto view_of = [](const tinygltf::Value& extension) {
      return extension.IsObject() && extension.Has("bufferView") && extension.Get("bufferView").IsInt()
                 ? extension.Get("bufferView").Get<int>()
                 : -1;
    };
    if (const auto former = primitive.extensions.find(kFormerSpzExtension); former != primitive.extensions.end())
      return view_of(former->second);
    const tinygltf::Value& extension = primitive.extensions.at(kSplatExtension);
    if (!extension.Has("extensions") || !extension.Get("extensions").IsObject()) return std::nullopt;
    for (const std::string& name : extension.Get("extensions").Keys())
      if (name.starts_with(kSpzExtension)) return view_of(extension.Get("extensions").Get(name));
    return std::nullopt;
  }

  /// Decodes the splats of a primitive with SPZ, once for each buffer view.
  const SplatModel& spz_of(const Place& place) {
    const auto [known, is_new] = spz_.try_emplace(*place.spz);
    if (!is_new) return known->second;
    const std::span<const unsigned char> bytes = accessors_.view(*place.spz);
    auto problem = bytes.empty() ? std::optional<std::string>("its buffer view is missing; expected SPZ")
                                 : read_spz_model(std::as_bytes(bytes), builder_.budget(), known->second);
    if (problem) {
      builder_.fail("splats in SPZ: " + *problem);
      known->second = {};
    }
    return known->second;
  }

  /// Adds splats in SPZ. SPZ stores the axes right, up, back; the extension requires left, up, front.
  void add_spz(const Place& place) {
    const SplatModel& from = spz_of(place);
    const std::size_t first = splats_.size(), count = from.size();
    if (count == 0) return;
    splats_.format = "glTF KHR_gaussian_splatting with SPZ";
    if (const auto problem = splats_.append(from, 0, count, builder_.budget())) return builder_.fail(*problem);
    splats_.announced += count;
    const glm::vec3 axes = from.axes * glm::vec3(-1, 1, -1);
    const SplatTransform transform{glm::mat3(place.world)};
    const std::array<float, 15> signs = harmonic_signs(axes);
    const std::size_t per = qnv::harmonic_count(splats_.degree);
    for (std::size_t i = first; i < first + count; ++i) {
      splats_.positions[i] = glm::dmat4(place.world) * glm::dvec4(splats_.positions[i] * glm::dvec3(axes), 1);
      splats_.rotations[i] = turned(splats_.rotations[i], axes);
      transform.apply(splats_.scales[i], splats_.rotations[i]);
      if (per == 0) continue;
      const auto coefficients = std::span(splats_.coefficients).subspan(i * per, per);
      for (std::size_t k = 0; k < per; ++k) coefficients[k] *= signs[k];
      transform.apply(coefficients);
    }
  }

  [[nodiscard]] static int degree_of(const tinygltf::Primitive& primitive) {
    int degree = 0;
    while (degree < qnv::Gaussians::kMaxDegree) {
      for (int n = 0; n <= 2 * (degree + 1); ++n)
        if (splat_attribute(primitive, harmonic_name(degree + 1, n)) < 0) return degree;
      ++degree;
    }
    return degree;
  }

  /// Returns the numbers of an attribute, `count` elements. Reports an error if they cannot be read.
  std::optional<std::vector<float>> numbers(const tinygltf::Primitive& primitive, const std::string& name,
                                            int components, std::size_t count) {
    const int accessor = splat_attribute(primitive, name);
    auto values = accessor < 0 ? std::nullopt : accessors_.floats(accessor, components);
    if (values && (count == 0 || values->size() == count * static_cast<std::size_t>(components))) return values;
    builder_.fail("splats: " + name + ": " +
                  (accessor < 0 ? "is missing"
                   : values     ? "has " + std::to_string(values->size() / static_cast<std::size_t>(components)) +
                                  " values; expected " + std::to_string(count)
                            : accessors_.problem()));
    return std::nullopt;
  }

  /// Reports properties of the extension that change the picture.
  [[nodiscard]] bool check_extension(const tinygltf::Primitive& primitive) {
    const tinygltf::Value& extension = primitive.extensions.at(kSplatExtension);
    const auto text_of = [&](const char* key) {
      return extension.Has(key) && extension.Get(key).IsString() ? extension.Get(key).Get<std::string>()
                                                                 : std::string();
    };
    if (extension.Has("extensions") && extension.Get("extensions").IsObject())
      for (const std::string& name : extension.Get("extensions").Keys())
        if (name.find("compression") != std::string::npos) {
          builder_.fail("the compression of splats by " + name.substr(0, 100) +
                        " is not supported; expected SPZ, or no compression");
          return false;
        }
    if (const std::string kernel = text_of("kernel"); !kernel.empty() && kernel != "ellipse")
      builder_.warn("splats with the kernel '" + kernel.substr(0, 100) + "' are drawn as ellipses");
    linear_ = text_of("colorSpace") == "lin_rec709_display";
    if (linear_ && !std::exchange(linear_reported_, true))
      builder_.warn("the colours of splats are linear light; they are blended as display colours");
    return true;
  }

  void add(const Place& place) {
    const tinygltf::Primitive& primitive = *place.primitive;
    if (!check_extension(primitive)) return;
    const auto positions = numbers(primitive, "POSITION", 3, 0);
    if (!positions) return;
    const std::size_t count = positions->size() / 3, first = splats_.size();
    const auto rotations = numbers(primitive, prefix() + "ROTATION", 4, count);
    const auto scales = numbers(primitive, prefix() + "SCALE", 3, count);
    const auto opacities = numbers(primitive, prefix() + "OPACITY", 1, count);
    const auto dc = numbers(primitive, harmonic_name(0, 0), 3, count);
    if (!rotations || !scales || !opacities || !dc) return;
    if (const auto problem = splats_.draw(builder_.budget(), count)) return builder_.fail(*problem);
    splats_.announced += count;
    splats_.resize(first + count);
    const SplatTransform transform{glm::mat3(place.world)};
    for (std::size_t i = 0; i < count; ++i) {
      const auto vector = [i](const std::vector<float>& from) {
        return glm::vec3(from[3 * i], from[3 * i + 1], from[3 * i + 2]);
      };
      const std::size_t to = first + i;
      splats_.positions[to] = glm::dmat4(place.world) * glm::dvec4(vector(*positions), 1);
      splats_.scales[to] = vector(*scales);
      splats_.rotations[to] = {(*rotations)[4 * i], (*rotations)[4 * i + 1], (*rotations)[4 * i + 2],
                               (*rotations)[4 * i + 3]};
      transform.apply(splats_.scales[to], splats_.rotations[to]);
      splats_.opacities[to] = (*opacities)[i];
      splats_.dc[to] = display_dc(vector(*dc));
    }
    add_harmonics(primitive, first, count, transform);
  }

  /// Converts a coefficient of linear light to one of display colours.
  [[nodiscard]] glm::vec3 display_dc(const glm::vec3& dc) const {
    if (!linear_) return dc;
    glm::vec3 made;
    for (int k = 0; k < 3; ++k)
      made[k] =
          (display_of_linear(std::clamp(0.5f + kSphericalHarmonic0 * dc[k], 0.0f, 1.0f)) - 0.5f) / kSphericalHarmonic0;
    return made;
  }

  void add_harmonics(const tinygltf::Primitive& primitive, std::size_t first, std::size_t count,
                     const SplatTransform& transform) {
    const int degree = degree_of(primitive);
    std::size_t number = 0;
    for (int l = 1; l <= degree; ++l)
      for (int n = 0; n <= 2 * l; ++n, ++number) {
        const auto values = numbers(primitive, harmonic_name(l, n), 3, count);
        if (!values) return;
        for (std::size_t i = 0; i < count; ++i)
          splats_.coefficient(first + i, number) = {(*values)[3 * i], (*values)[3 * i + 1], (*values)[3 * i + 2]};
      }
    const std::size_t per = qnv::harmonic_count(splats_.degree);
    if (degree == 0) return;
    for (std::size_t i = first; i < first + count; ++i)
      transform.apply(std::span(splats_.coefficients).subspan(i * per, per));
  }

  const tinygltf::Model& model_;
  SceneBuilder& builder_;
  GltfAccessors accessors_;
  SplatModel splats_;
  std::vector<Place> places_;
  std::map<int, SplatModel> spz_;  // decoded splats, by buffer view
  std::size_t others_ = 0;
  bool linear_ = false, linear_reported_ = false;
};

}  // namespace

bool is_gltf_splats(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  const bool gltf = text.starts_with("glTF") || (begin != std::string_view::npos && text[begin] == '{');
  const auto has = [&](const char* name) { return text.find('"' + std::string(name) + '"') != std::string_view::npos; };
  return gltf && (has(kSplatExtension) || has(kFormerSpzExtension));
}

Asset read_gltf_splats(const ImportSource& source) {
  vrml::SceneGraph scene(source.path, source.budget);
  SceneBuilder builder(scene, source.diagnostics);
  try {
    const auto model = load_gltf(source.bytes, source.read_file, builder);
    if (!model) return {};
    SplatReader reader(*model, builder);
    ImportedVectors imported = import_result(reader.read());
    if (auto* discs = std::get_if<qnv::Splats>(&imported)) return std::move(*discs);
    if (auto* gaussians = std::get_if<qnv::Gaussians>(&imported)) return std::move(*gaussians);
    builder.fail(std::get<std::string>(imported));
  } catch (const OutOfBudget&) {
    if (!source.budget->stopped()) builder.fail(source.budget->refusal(Resource::nodes));
  }
  return {};
}

}  // namespace gs::app
