#include "app/view/values/slice_scene.h"

#include "app/view/values/color_maps.h"
#include "app/view/values/fine_values.h"
#include "qnv/codecs/shared/volume_detail.h"
#include "qnv/sampling/volume/label_vectors.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

constexpr std::size_t kMostSlicePixels = std::size_t{1} << 23;

/// Returns the two other axes, which are those of the slice's picture.
std::pair<std::size_t, std::size_t> axes_across(std::size_t axis) {
  return axis == 0   ? std::pair<std::size_t, std::size_t>{1, 2}
         : axis == 1 ? std::pair<std::size_t, std::size_t>{0, 2}
                     : std::pair<std::size_t, std::size_t>{0, 1};
}

std::shared_ptr<const vrml::Mesh> plane_mesh(const std::array<glm::vec3, 4>& corners) {
  auto mesh = std::make_shared<vrml::Mesh>();
  const glm::vec3 cross = glm::cross(corners[1] - corners[0], corners[3] - corners[0]);
  const float length = glm::length(cross);
  const glm::vec3 normal = length > 0 ? cross / length : glm::vec3(0, 0, 1);
  static constexpr std::array<glm::vec2, 4> kPlaces{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  for (std::size_t i = 0; i < 4; ++i) {
    mesh->positions.push_back(corners[i]);
    mesh->normals.push_back(normal);
    mesh->texture_coordinates.push_back(kPlaces[i]);
    mesh->bounds.add(corners[i]);
  }
  mesh->indices = {0, 1, 2, 0, 2, 3};
  mesh->solid = false;
  return mesh;
}

std::shared_ptr<const vrml::Mesh> frame_mesh(const std::array<glm::vec3, 4>& corners) {
  auto mesh = std::make_shared<vrml::Mesh>();
  mesh->primitive = vrml::Mesh::Primitive::lines;
  for (const glm::vec3& corner : corners) {
    mesh->positions.push_back(corner);
    mesh->bounds.add(corner);
  }
  mesh->indices = {0, 1, 1, 2, 2, 3, 3, 0};
  mesh->lit = false;
  return mesh;
}

/// Colours of the values on a slice: those of a map over a range, or of labels.
class SliceColors {
 public:
  using Color = std::array<std::uint8_t, 3>;

  SliceColors(const VolumeGrid& grid, const VolumeSlices& slices)
      : grid_(grid), range_(slices.window.value_or(grid.value_range())) {
    const ColorMap* chosen = find_color_map(slices.map);
    const ColorMap& map = chosen ? *chosen : color_maps().front();
    labels_ = grid.layout().labels && &map == &color_maps().front();
    for (std::size_t i = 0; i < colors_.size(); ++i) {
      const glm::vec3 color = color_at(map, static_cast<float>(i) / 255) * 255.0f;
      for (int c = 0; c < 3; ++c)
        colors_[i][static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(std::lround(color[c]));
    }
  }
  [[nodiscard]] Color operator()(float value) {
    if (labels_) {
      if (value != last_) {
        last_ = value;
        const qnv::Rgb8 color = qnv::label_color(grid_.label_of(value));
        last_color_ = {color.r, color.g, color.b};
      }
      return last_color_;
    }
    const auto [least, most] = range_;
    const float place = most > least ? (value - least) / (most - least) : value > least ? 1.0f : 0.0f;
    return colors_[static_cast<std::size_t>(std::lround(std::clamp(place, 0.0f, 1.0f) * 255))];
  }

 private:
  const VolumeGrid& grid_;
  const std::pair<float, float> range_;
  std::array<Color, 256> colors_{};
  bool labels_ = false;
  float last_ = std::numeric_limits<float>::quiet_NaN();
  Color last_color_{};
};

render::Image color_slice(const VolumeGrid& grid, const VolumeSlices& slices, std::size_t axis) {
  const auto [across, up] = axes_across(axis);
  render::Image image{grid.kept(across), grid.kept(up), 4, {}};
  image.pixels.reserve(std::size_t{image.width} * image.height * 4);
  std::array<std::uint32_t, 3> at{};
  at[axis] = slice_voxel(grid, slices, axis) / grid.step();
  for (std::uint32_t row = image.height; row-- > 0;)
    for (std::uint32_t column = 0; column < image.width; ++column) {
      at[across] = column;
      at[up] = row;
      const auto& color = grid.kept_color(at[0], at[1], at[2]);
      image.pixels.insert(image.pixels.end(), color.begin(), color.end());
    }
  return image;
}

bool has_own_map(const VolumeSlices& slices) {
  const ColorMap* const map = find_color_map(slices.map);
  return !map || map == &color_maps().front();
}

}  // namespace

double slice_voxel(const VolumeGrid& grid, const VolumeSlices& slices, std::size_t axis) {
  const double place = std::clamp(static_cast<double>(slices.places[axis]), 0.0, 1.0);
  const double voxel = std::round(place * (grid.whole()[axis] - 1.0)) / grid.fineness(axis);
  return grid.step() == 1 ? voxel : std::floor(voxel / grid.step()) * grid.step();
}

std::vector<glm::dvec4> slice_planes(const VolumeGrid& grid, const VolumeSlices& slices,
                                     const glm::dmat4& world_from_node) {
  std::vector<glm::dvec4> planes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!slices.shown[axis]) continue;
    std::array<glm::dvec3, 4> corners = slice_corners(grid, slices, axis);
    for (glm::dvec3& corner : corners) corner = glm::dvec3(world_from_node * glm::dvec4(corner, 1));
    const glm::dvec3 cross = glm::cross(corners[1] - corners[0], corners[3] - corners[0]);
    const double length = glm::length(cross);
    if (length > 0) planes.emplace_back(cross / length, -glm::dot(cross / length, corners[0]));
  }
  return planes;
}

std::array<glm::dvec3, 4> slice_corners(const VolumeGrid& grid, const VolumeSlices& slices, std::size_t axis) {
  const auto [across, up] = axes_across(axis);
  std::array<glm::dvec3, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    glm::dvec3 voxel(0);
    voxel[static_cast<int>(axis)] = slice_voxel(grid, slices, axis);
    // A pixel is a voxel. The outer pixels extend half a voxel beyond the voxels' centres.
    const auto edge = [&](std::size_t of, bool upper) {
      return upper ? (grid.kept(of) - 0.5) * grid.step() : -0.5 * grid.step();
    };
    voxel[static_cast<int>(across)] = edge(across, i == 1 || i == 2);
    voxel[static_cast<int>(up)] = edge(up, i >= 2);
    corners[i] = grid.place_of(voxel);
  }
  return corners;
}

render::Image slice_image(const VolumeGrid& grid, const VolumeSlices& slices, std::size_t axis) {
  if (grid.has_colors() && has_own_map(slices)) return color_slice(grid, slices, axis);
  SliceColors colors(grid, slices);
  const auto [across, up] = axes_across(axis);
  // Finer parts of a volume that is larger than memory have more pixels.
  const FineValues fine(grid, FineValues::factor_for(grid, kMostSlicePixels, static_cast<int>(axis)));
  render::Image image{fine.size()[across], fine.size()[up], 4, {}};
  image.pixels.resize(std::size_t{image.width} * image.height * 4);
  std::array<std::uint32_t, 3> at{}, count = fine.size();
  // The plane may lie between the samples that are known.
  const double plane = slice_voxel(grid, slices, axis) / grid.step() * fine.factors()[axis];
  at[axis] = std::min(static_cast<std::uint32_t>(std::lround(plane)), fine.size()[axis] - 1);
  count[axis] = 1;
  std::vector<float> values;
  fine.read(at, count, values);
  // A voxel is as wide as `factor` pixels, in the middle of which its sample lies.
  const auto sample = [&](std::size_t of, std::uint32_t pixel) {
    const std::uint32_t half = (fine.factors()[of] - 1) / 2;
    return std::size_t{pixel - std::min(pixel, half)};
  };
  bool missing = false;
  std::uint8_t* to = image.pixels.data();
  for (std::uint32_t row = image.height; row-- > 0;)
    for (std::uint32_t column = 0; column < image.width; ++column, to += 4) {
      const float value = values[sample(up, row) * image.width + sample(across, column)];
      if (value != value) {
        missing = true;
        continue;  // leave the pixel transparent
      }
      const SliceColors::Color color = colors(value);
      std::copy(color.begin(), color.end(), to);
      to[3] = 255;
    }
  if (missing) return image;
  render::Image opaque{image.width, image.height, 3, {}};
  opaque.pixels.reserve(image.pixels.size() / 4 * 3);
  for (std::size_t i = 0; i < image.pixels.size(); i += 4)
    opaque.pixels.insert(opaque.pixels.end(), image.pixels.begin() + static_cast<std::ptrdiff_t>(i),
                         image.pixels.begin() + static_cast<std::ptrdiff_t>(i + 3));
  return opaque;
}

std::shared_ptr<const qnv::VolumeValues> streamed_values(const render::RenderList& list) {
  for (const render::SplatItem& item : list.splats)
    if (const auto* volume = item.geometry ? item.geometry->as<qnv::Volume>() : nullptr) {
      // Views of a volume that is larger than memory decode finer values.
      const auto latest = volume->detail ? volume->detail->latest() : nullptr;
      return latest ? latest->values : volume->values;
    }
  return nullptr;
}

void hide_volumes(render::RenderList& list) {
  const auto volume_of = [](const render::SplatItem& item) {
    return item.geometry ? item.geometry->as<qnv::Volume>() : nullptr;
  };
  std::erase_if(list.splats,
                [&](const render::SplatItem& item) { return volume_of(item) && !volume_of(item)->detail; });
  for (render::SplatItem& item : list.splats)
    if (volume_of(item)) item.material.transparency = 1;
}

std::uint64_t detail_revision(const render::RenderList& list) {
  std::uint64_t revision = 0;
  for (const render::SplatItem& item : list.splats)
    if (const auto* volume = item.geometry ? item.geometry->as<qnv::Volume>() : nullptr; volume && volume->detail)
      revision += volume->detail->revision();
  return revision;
}

std::optional<glm::dmat4> world_from_volume(const render::RenderList& list) {
  for (const render::SplatItem& item : list.splats)
    if (item.geometry && item.geometry->as<qnv::Volume>()) return item.world_from_node;
  return std::nullopt;
}

const render::RenderList& SliceScene::with_slices(const render::RenderList& list,
                                                  const std::shared_ptr<const VolumeGrid>& grid,
                                                  const VolumeSlices& slices) {
  const auto world_from_node = world_from_volume(list);
  if (!grid || !slices.any() || !world_from_node) return list;
  const bool same_list = of_ == &list && generation_ == list.generation && changes_ == list.changes &&
                         items_ == list.items.size() && world_from_node_ == *world_from_node;
  if (same_list && grid_ == grid && slices_ == slices) return list_;
  const bool same_look = grid_ == grid && slices_.map == slices.map && slices_.window == slices.window;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool same =
        same_look && images_[axis] && slice_voxel(*grid, slices, axis) == slice_voxel(*grid, slices_, axis);
    if (slices.shown[axis] && !same)
      images_[axis] = std::make_shared<const render::Image>(slice_image(*grid, slices, axis));
  }
  list_ = list;
  list_.generation = 0;
  list_.changes = render::next_change();
  list_.moved.clear();
  if (slices.alone) hide_volumes(list_);
  static constexpr std::array<glm::vec3, 3> kColors{{{0.9f, 0.35f, 0.3f}, {0.4f, 0.8f, 0.35f}, {0.35f, 0.55f, 0.95f}}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!slices.shown[axis]) {
      images_[axis].reset();
      continue;
    }
    const auto places = slice_corners(*grid, slices, axis);
    const std::array<glm::vec3, 4> corners{places[0], places[1], places[2], places[3]};
    render::DrawItem plane;
    plane.mesh = plane_mesh(corners);
    plane.world_from_node = *world_from_node;
    plane.material.lit = false;
    plane.material.diffuse = glm::vec3(1);
    plane.texture = {images_[axis], false, false, glm::mat3(1.0f)};
    render::DrawItem frame;
    frame.mesh = frame_mesh(corners);
    frame.world_from_node = *world_from_node;
    frame.material.diffuse = glm::vec3(0);
    frame.material.emissive = kColors[axis];
    for (const glm::vec3& corner : corners)
      list_.bounds.add(glm::vec3(*world_from_node * glm::dvec4(glm::dvec3(corner), 1)));
    list_.items.push_back(std::move(plane));
    list_.items.push_back(std::move(frame));
  }
  of_ = &list;
  generation_ = list.generation;
  changes_ = list.changes;
  items_ = list.items.size();
  grid_ = grid;
  slices_ = slices;
  world_from_node_ = *world_from_node;
  return list_;
}

}  // namespace gs::app
