#include "app/encode/outline_model.h"

#include "app/encode/surface_triangles.h"
#include "net/base/url.h"
#include "render/image/image.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace gs::app {
namespace {

auto key_of(const qnv::OutlineAppearance& a) {
  const auto rgb = [](const qnv::Rgb8& c) { return c.r << 16 | c.g << 8 | c.b; };
  return std::tuple(rgb(a.diffuse), rgb(a.emissive), rgb(a.specular), a.ambient_intensity, a.shininess, a.transparency,
                    a.lit, a.solid, a.textured, a.crease_angle, a.texture_url);
}

// Returns true if a vertex normal of a triangle differs from the normal of its face.
bool is_bent(const vrml::Mesh& mesh, const std::array<std::uint32_t, 3>& corners) {
  constexpr float kFlat = 0.99999f;
  const auto at = [&](std::size_t k) { return mesh.positions[corners[k]]; };
  const glm::vec3 n = glm::cross(at(1) - at(0), at(2) - at(0));
  const float length = std::sqrt(glm::dot(n, n));
  return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t corner) {
    return !(std::abs(glm::dot(mesh.normals[corner], n)) >= kFlat * length);
  });
}

std::string base64(std::span<const std::byte> bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

class Builder {
 public:
  explicit Builder(const TextureUrls& textures) : textures_(textures) {}

  void add(const render::DrawItem& item) {
    const vrml::Mesh& mesh = *item.mesh;
    qnv::OutlineAppearance look = look_of(item);
    const glm::mat3 m(item.world_from_node);
    const bool flipped = glm::dot(m[0], glm::cross(m[1], m[2])) < 0;
    const bool colored = mesh.colors.size() == mesh.positions.size();
    std::uint32_t appearance = colored ? 0 : number_of(look);
    qnv::PolygonModel& model = out_.model;
    const auto base = static_cast<std::uint32_t>(model.positions.size());
    for (const glm::vec3& p : mesh.positions)
      model.positions.push_back(glm::vec3(item.world_from_node * glm::dvec4(p, 1)));
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      std::array<std::uint32_t, 3> corners{mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]};
      if (flipped) std::swap(corners[1], corners[2]);
      if (colored) {
        appearance = number_of(with_color(look, mesh, corners));
      }
      for (const std::uint32_t corner : corners) {
        model.corners.push_back(base + corner);
        if (!look.textured) continue;
        // Earlier polygons may have no texture coordinates. Add zeros for them.
        model.texture_coordinates.resize(model.corners.size() - 1);
        const glm::vec3 st = item.texture.transform * glm::vec3(mesh.texture_coordinates[corner], 1.0f);
        model.texture_coordinates.emplace_back(st.x, st.y);
      }
      model.ends.push_back(static_cast<std::uint32_t>(model.corners.size()));
      model.appearances.push_back(appearance);
      model.bent.push_back(look.crease_angle > 0 && is_bent(mesh, corners) ? 1 : 0);
    }
  }
  void count_omitted() { ++out_.omitted; }
  [[nodiscard]] OutlineModel take() {
    if (!out_.model.texture_coordinates.empty()) out_.model.texture_coordinates.resize(out_.model.corners.size());
    return std::move(out_);
  }

 private:
  qnv::OutlineAppearance look_of(const render::DrawItem& item) {
    const render::Material& material = item.material;
    qnv::OutlineAppearance look;
    look.lit = material.lit;
    look.diffuse = material.lit ? to_rgb8(material.diffuse) : qnv::Rgb8{255, 255, 255};
    if (material.lit) {
      look.emissive = to_rgb8(material.emissive);
      look.specular = to_rgb8(material.specular);
      look.ambient_intensity = to_byte(material.ambient_intensity);
      look.shininess = to_byte(material.shininess);
      look.transparency = to_byte(material.transparency);
    }
    look.solid = item.mesh->solid;
    const auto [at, fresh] = creases_.try_emplace(item.mesh.get(), 0.0f);
    if (fresh) at->second = crease_angle_of(*item.mesh);
    look.crease_angle = at->second;
    const auto url = item.texture.image ? textures_.find(item.texture.image.get()) : textures_.end();
    look.textured = url != textures_.end() && item.mesh->texture_coordinates.size() == item.mesh->positions.size();
    if (look.textured) look.texture_url = url->second;
    return look;
  }
  qnv::OutlineAppearance with_color(qnv::OutlineAppearance look, const vrml::Mesh& mesh,
                                    const std::array<std::uint32_t, 3>& corners) {
    glm::vec3 sum(0);
    for (const std::uint32_t corner : corners) {
      const vrml::Color& c = mesh.colors[corner];
      sum += glm::vec3(c.r, c.g, c.b) / 3.0f;
      const vrml::Color& first = mesh.colors[corners[0]];
      out_.averaged = out_.averaged || c.r != first.r || c.g != first.g || c.b != first.b;
    }
    look.diffuse = to_rgb8(sum);
    // With too many colours, each triangle could become a group. Reduce the colours to five bits per channel.
    if (out_.appearances.size() > kManyColors)
      for (std::uint8_t* c : {&look.diffuse.r, &look.diffuse.g, &look.diffuse.b})
        *c = static_cast<std::uint8_t>((*c & 0xf8) | *c >> 5);
    return look;
  }
  std::uint32_t number_of(const qnv::OutlineAppearance& look) {
    const auto [at, fresh] = numbers_.try_emplace(key_of(look), static_cast<std::uint32_t>(out_.appearances.size()));
    if (fresh && out_.appearances.size() >= qnv::kMaxOutlineAppearances) {
      at->second = 0;
    } else if (fresh) {
      out_.appearances.push_back(look);
    }
    return at->second;
  }

  static constexpr std::size_t kManyColors = 4096;
  const TextureUrls& textures_;
  OutlineModel out_;
  std::map<decltype(key_of({})), std::uint32_t> numbers_;
  std::unordered_map<const vrml::Mesh*, float> creases_;
};

}  // namespace

TextureUrls texture_urls(const LoadedWorld& world) {
  TextureUrls urls;
  if (!world.scene) return urls;
  const net::Url asked = net::parse_url(world.path);
  const net::Url base = asked.scheme.empty() ? net::url_of_path(world.path) : asked;
  for (std::uint32_t i = 1; i <= world.scene->nodes().count(); ++i) {
    const vrml::NodeId id = world.scene->nodes().id_at(i);
    const auto found = world.images.find(&world.scene->node(id));
    if (found == world.images.end() || !world.scene->resolve_as(id, vrml::NodeKind::image_texture)) continue;
    const auto& list = world.scene->get<vrml::MFString>(id, "url");
    const int slot = world.scene->node(id).type->find_field("url")->slot;
    // In a PROTO library, the url is relative to the library, not to the world.
    if (!list.empty() && &world.scene->nodes().text_of(id, slot) == world.scene.get())
      urls.emplace(found->second.get(), net::resolve(base, net::parse_url(net::tidy_url(list.front().view()))).text());
  }
  // Embed all other textures as data: URLs. They come from Inlines, libraries, importers and PixelTextures.
  for (const auto& [place, image] : world.images)
    if (image && !urls.contains(image.get()))
      urls.emplace(image.get(), "data:image/png;base64," + base64(render::encode_png(*image)));
  return urls;
}

OutlineModel outline_model(const render::RenderList& list, const TextureUrls& textures) {
  Builder builder(textures);
  for (const render::DrawItem& item : list.items)
    if (has_surface(item))
      builder.add(item);
    else
      builder.count_omitted();
  return builder.take();
}

OutlineModel outline_model(const std::function<bool(const qnv::TriangleSink&)>& source, bool two_sided) {
  OutlineModel out;
  qnv::OutlineAppearance look;
  look.solid = !two_sided;
  look.crease_angle = 3.1416f;
  look.diffuse = {204, 204, 204};
  out.appearances.push_back(look);
  const bool whole = source([&](std::span<const qnv::Triangle> triangles) {
    for (const qnv::Triangle& triangle : triangles) {
      for (const glm::vec3& p : triangle.positions) {
        out.model.corners.push_back(static_cast<std::uint32_t>(out.model.positions.size()));
        out.model.positions.push_back(p);
      }
      out.model.ends.push_back(static_cast<std::uint32_t>(out.model.corners.size()));
      out.model.appearances.push_back(0);
    }
    return out.model.corners.size() < 0xf0000000u;
  });
  if (!whole) out.model = {};
  return out;
}

}  // namespace gs::app
