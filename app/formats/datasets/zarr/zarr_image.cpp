#include "app/formats/datasets/zarr/zarr_image.h"

#include "app/formats/datasets/zarr/zarr_metadata.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace gs::app {
namespace {

using nlohmann::json;

constexpr std::size_t kMostOmeLevels = 64, kMostOmeImages = 64, kMostOmeChannels = 4096;

std::string ome_text(const json& object, const char* name) {
  const json& value = zarr_member(object, name);
  return value.is_string() ? value.get<std::string>().substr(0, 256) : std::string();
}

/// Returns `count` finite numbers, or nothing.
std::vector<double> ome_numbers(const json& list, std::size_t count) {
  std::vector<double> numbers;
  if (!list.is_array() || list.size() != count) return {};
  for (const json& one : list) {
    if (!one.is_number() || !std::isfinite(one.get<double>())) return {};
    numbers.push_back(one.get<double>());
  }
  return numbers;
}

std::vector<ZarrAxis> ome_axes(const json& image) {
  const json* list = &zarr_member(image, "axes");
  // OME-Zarr 0.6: the last transformation leads into the coordinate system that comes first.
  if (const json& systems = zarr_member(image, "coordinateSystems");
      !list->is_array() && systems.is_array() && !systems.empty())
    list = &zarr_member(systems.front(), "axes");
  std::vector<ZarrAxis> axes;
  if (list->is_array())
    for (const json& one : *list) {
      if (axes.size() == kMostZarrDimensions) break;
      if (one.is_string())
        axes.push_back({one.get<std::string>(), {}, {}});  // OME-Zarr 0.3
      else
        axes.push_back({ome_text(one, "name"), ome_text(one, "type"), ome_text(one, "unit")});
    }
  if (axes.empty())  // OME-Zarr 0.1 and 0.2: always five
    for (const char* const name : {"t", "c", "z", "y", "x"}) axes.push_back({name, {}, {}});
  for (ZarrAxis& axis : axes)
    if (axis.type.empty()) axis.type = axis.name == "t" ? "time" : axis.name == "c" ? "channel" : "space";
  return axes;
}

/// OmeMatrix from the array to the world: a row per axis, with the shift in its last number.
using OmeMatrix = std::vector<std::vector<double>>;

OmeMatrix ome_identity(std::size_t count) {
  OmeMatrix matrix(count, std::vector<double>(count + 1));
  for (std::size_t i = 0; i < count; ++i) matrix[i][i] = 1;
  return matrix;
}

/// Returns `second` after `first`.
OmeMatrix ome_product(const OmeMatrix& second, const OmeMatrix& first) {
  const std::size_t count = first.size();
  OmeMatrix result(count, std::vector<double>(count + 1));
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j <= count; ++j)
      for (std::size_t k = 0; k < count; ++k) result[i][j] += second[i][k] * first[k][j];
    result[i][count] += second[i][count];
  }
  return result;
}

/// Returns the matrix of a transformation; the identity for kinds that are no matrices, such as fields of offsets.
OmeMatrix ome_matrix(const json& transformation, std::size_t count, int depth) {
  OmeMatrix matrix = ome_identity(count);
  const std::string type = ome_text(transformation, "type");
  if (type == "scale") {
    const auto scale = ome_numbers(zarr_member(transformation, "scale"), count);
    for (std::size_t i = 0; i < scale.size(); ++i) matrix[i][i] = scale[i];
  } else if (type == "translation") {
    const auto shift = ome_numbers(zarr_member(transformation, "translation"), count);
    for (std::size_t i = 0; i < shift.size(); ++i) matrix[i][count] = shift[i];
  } else if (type == "affine" || type == "rotation") {
    const json& rows = zarr_member(transformation, type.c_str());
    const bool shifts = type == "affine";
    if (!rows.is_array() || rows.size() != count) return matrix;
    for (std::size_t i = 0; i < count; ++i) {
      const auto row = ome_numbers(rows[i], count + (shifts ? 1 : 0));
      if (row.empty()) return ome_identity(count);
      std::copy(row.begin(), row.end(), matrix[i].begin());
    }
  } else if (type == "sequence" && depth < 8) {
    const json& parts = zarr_member(transformation, "transformations");
    if (parts.is_array() && parts.size() <= kMostOmeLevels)
      for (const json& part : parts) matrix = ome_product(ome_matrix(part, count, depth + 1), matrix);
  }
  return matrix;
}

OmeMatrix ome_matrix_of_list(const json& list, std::size_t count) {
  OmeMatrix matrix = ome_identity(count);
  if (list.is_array() && list.size() <= kMostOmeLevels)
    for (const json& one : list) matrix = ome_product(ome_matrix(one, count, 0), matrix);
  return matrix;
}

}  // namespace

std::vector<ZarrImage> zarr_images(const json& attributes, const std::string& group) {
  const json& ome = zarr_member(attributes, "ome").is_object() ? zarr_member(attributes, "ome") : attributes;
  const json& list = zarr_member(ome, "multiscales");
  std::vector<ZarrImage> images;
  if (!list.is_array()) return images;
  for (const json& one : list) {
    if (images.size() == kMostOmeImages) break;
    ZarrImage image;
    image.group = group;
    image.name = ome_text(one, "name");
    image.labels = zarr_member(ome, "image-label").is_object();
    image.axes = ome_axes(one);
    const std::size_t count = image.axes.size();
    const OmeMatrix outer = ome_matrix_of_list(zarr_member(one, "coordinateTransformations"), count);
    bool diagonal = true;
    const json& levels = zarr_member(one, "datasets");
    if (!levels.is_array()) continue;
    for (const json& level : levels) {
      const std::string path = ome_text(level, "path");
      if (path.empty() || image.levels.size() == kMostOmeLevels) continue;
      const OmeMatrix whole =
          ome_product(outer, ome_matrix_of_list(zarr_member(level, "coordinateTransformations"), count));
      ZarrLevel made{path, {}, {}};
      for (std::size_t i = 0; i < count; ++i) {
        made.scale.push_back(whole[i][i]);
        made.translation.push_back(whole[i][count]);
        for (std::size_t j = 0; j < count; ++j) diagonal = diagonal && (i == j || whole[i][j] == 0);
      }
      if (!diagonal) made.matrix = whole;
      image.levels.push_back(std::move(made));
    }
    const json& channels = zarr_member(zarr_member(ome, "omero"), "channels");
    if (channels.is_array())
      for (const json& channel : channels)
        if (image.channels.size() < kMostOmeChannels) image.channels.push_back(ome_text(channel, "label"));
    if (!image.levels.empty()) images.push_back(std::move(image));
  }
  return images;
}

}  // namespace gs::app
