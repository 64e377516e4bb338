#pragma once

#include "app/formats/datasets/arrays/array_file.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Image of a TIFF file: which page has each plane, and the distances of voxels.
struct TiffImage {
  static constexpr std::uint32_t kNoPage = 0xffffffff;

  std::size_t array = 0;  // of the file of pages
  std::uint64_t times = 1, slices = 1, channels = 1;
  std::vector<std::uint32_t> pages;  // of each plane: time is the slowest axis, the channel the fastest
  double spacing_x = 1, spacing_y = 1, spacing_z = 1;
  double time_step = 1;
  std::string unit, time_unit;             // "um", "s"; empty if unknown
  std::vector<std::string> channel_names;  // of each channel, or none
  bool described = false;                  // the file states the meaning of its pages

  /// Returns the page of a plane, or kNoPage.
  [[nodiscard]] std::uint32_t page(std::uint64_t time, std::uint64_t slice, std::uint64_t channel) const {
    return pages[(time * slices + slice) * channels + channel];
  }
};

/// Finds the images in the pages of a file, by the descriptions of OME, ImageJ or tifffile. Without these, the pages
/// are slices. `file_name` is the name of the file, to which OME-XML may refer. `missing` gets the number of planes
/// that lie in other files.
[[nodiscard]] std::vector<TiffImage> tiff_images(ArrayFile& pages, std::string_view file_name, std::size_t& missing);

/// Reads a description in OME-XML: its images that have some of the `page_count` pages of the file. TiffImage::array is
/// 0. Returns none if the description is damaged. `missing` gets the number of planes that lie in other files.
[[nodiscard]] std::vector<TiffImage> ome_images(std::string_view xml, std::size_t page_count,
                                                std::string_view file_name, std::size_t& missing);

/// Returns a unit of length or time in ASCII: "um" for a micrometre in its spellings.
[[nodiscard]] std::string plain_unit(std::string_view unit);

}  // namespace gs::app
