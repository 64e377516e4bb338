#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <string>
#include <vector>

// Images of OME-Zarr 0.1 to 0.6 (https://ngff.openmicroscopy.org).
namespace gs::app {

/// Axis of an image.
struct ZarrAxis {
  std::string name, type, unit;  // "z", "space", "micrometer"
};

/// Level of the pyramid of an image.
struct ZarrLevel {
  std::string path;                        // of its array
  std::vector<double> scale, translation;  // one number per axis
  /// Matrix from indices to the world, if axes are turned or sheared: a row per axis, with the shift in its last
  /// number.
  std::vector<std::vector<double>> matrix = {};
};

/// Image with a pyramid, the finest level first.
struct ZarrImage {
  std::string group;  // path of its group, "/" for the root
  std::string name;
  bool labels = false;
  std::vector<ZarrAxis> axes;  // as the dimensions of the arrays
  std::vector<ZarrLevel> levels;
  std::vector<std::string> channels;  // their labels
};

/// Returns the images that the attributes of a group describe. Ignores images with malformed metadata.
[[nodiscard]] std::vector<ZarrImage> zarr_images(const nlohmann::json& attributes, const std::string& group);

}  // namespace gs::app
