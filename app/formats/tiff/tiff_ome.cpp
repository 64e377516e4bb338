#include "app/formats/tiff/tiff_layout.h"

#include "base/text.h"

#include <expat.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

// Reader of OME-XML in the description of a TIFF file (docs.openmicroscopy.org, OME-TIFF specification).

namespace gs::app {
namespace {

constexpr std::uint64_t kMostPlanes = 1'000'000;

/// Block of planes: pages from `first` on are planes from z, c, t on.
struct OmePlanes {
  std::uint64_t first = 0, z = 0, c = 0, t = 0;
  std::optional<std::uint64_t> count;
  bool elsewhere = false;  // in another file
};

/// Element Pixels of an image.
struct OmePixels {
  std::string order = "XYZCT";
  std::uint64_t z = 1, c = 1, t = 1;
  std::array<double, 3> sizes{0, 0, 0};
  double time_step = 1;
  std::array<std::string, 3> units;
  std::string time_unit;
  std::vector<std::pair<std::string, std::uint64_t>> channels;  // name, and samples per pixel
  std::vector<OmePlanes> planes;
  bool in_plane = false;
};

struct OmeParse {
  std::string_view file_name;
  std::vector<OmePixels> images;
};

std::string_view ome_attribute(const XML_Char** attributes, std::string_view name) {
  constexpr std::size_t kMost = 4096;
  for (; attributes[0]; attributes += 2)
    if (attributes[0] == name) return {attributes[1], strnlen(attributes[1], kMost)};
  return {};
}

std::uint64_t ome_count(const XML_Char** attributes, std::string_view name, std::uint64_t otherwise) {
  const std::string_view text = ome_attribute(attributes, name);
  std::uint64_t value = otherwise;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  return read.ec == std::errc() ? value : otherwise;
}

double ome_size(const XML_Char** attributes, std::string_view name) {
  const std::string_view text = ome_attribute(attributes, name);
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return std::isfinite(value) && value > 0 && value < 1e12 ? value : 0;
}

std::string_view without_prefix(std::string_view element) {
  const std::size_t colon = element.rfind(':');
  return colon == std::string_view::npos ? element : element.substr(colon + 1);
}

void begin_pixels(OmeParse& parse, const XML_Char** attributes) {
  constexpr std::size_t kMostImages = 4096;
  if (parse.images.size() >= kMostImages) return;
  OmePixels pixels;
  if (const std::string_view order = ome_attribute(attributes, "DimensionOrder"); order.size() == 5)
    pixels.order = order;
  pixels.z = std::max<std::uint64_t>(ome_count(attributes, "SizeZ", 1), 1);
  pixels.c = std::max<std::uint64_t>(ome_count(attributes, "SizeC", 1), 1);
  pixels.t = std::max<std::uint64_t>(ome_count(attributes, "SizeT", 1), 1);
  static constexpr std::array<std::array<std::string_view, 2>, 3> kSizes{{{"PhysicalSizeX", "PhysicalSizeXUnit"},
                                                                          {"PhysicalSizeY", "PhysicalSizeYUnit"},
                                                                          {"PhysicalSizeZ", "PhysicalSizeZUnit"}}};
  for (std::size_t i = 0; i < 3; ++i) {
    pixels.sizes[i] = ome_size(attributes, kSizes[i][0]);
    const std::string_view unit = ome_attribute(attributes, kSizes[i][1]);
    pixels.units[i] = unit.empty() ? "um" : plain_unit(unit);
  }
  if (const double step = ome_size(attributes, "TimeIncrement"); step > 0) {
    const std::string_view unit = ome_attribute(attributes, "TimeIncrementUnit");
    pixels.time_step = step;
    pixels.time_unit = unit.empty() ? "s" : plain_unit(unit);
  }
  parse.images.push_back(std::move(pixels));
}

void begin_ome(void* user, const XML_Char* element, const XML_Char** attributes) {
  auto& parse = *static_cast<OmeParse*>(user);
  const std::string_view name = without_prefix(element);
  if (name == "Pixels") return begin_pixels(parse, attributes);
  if (parse.images.empty()) return;
  OmePixels& pixels = parse.images.back();
  if (name == "Channel" && pixels.channels.size() < kMostPlanes) {
    pixels.channels.emplace_back(std::string(ome_attribute(attributes, "Name").substr(0, 64)),
                                 std::max<std::uint64_t>(ome_count(attributes, "SamplesPerPixel", 1), 1));
  } else if (name == "TiffData" && pixels.planes.size() < kMostPlanes) {
    OmePlanes planes;
    const bool numbered = !ome_attribute(attributes, "IFD").empty();
    planes.first = ome_count(attributes, "IFD", 0);
    planes.z = ome_count(attributes, "FirstZ", 0);
    planes.c = ome_count(attributes, "FirstC", 0);
    planes.t = ome_count(attributes, "FirstT", 0);
    if (!ome_attribute(attributes, "PlaneCount").empty())
      planes.count = ome_count(attributes, "PlaneCount", 1);
    else if (numbered)
      planes.count = 1;
    pixels.planes.push_back(planes);
  } else if (name == "UUID" && !pixels.planes.empty()) {
    const std::string_view other = ome_attribute(attributes, "FileName");
    const std::string_view alone =
        other.substr(other.find_last_of("/\\") == std::string_view::npos ? 0 : other.find_last_of("/\\") + 1);
    if (!alone.empty() && alone != parse.file_name) pixels.planes.back().elsewhere = true;
  }
}

/// Number of a plane among all planes in the order of the file.
struct OmeOrder {
  std::array<std::uint64_t, 3> sizes;  // of z, c, t
  std::array<std::size_t, 3> axes;     // the fastest first: 0 for z, 1 for c, 2 for t

  [[nodiscard]] std::array<std::uint64_t, 3> place(std::uint64_t number) const {
    std::array<std::uint64_t, 3> at{};
    for (const std::size_t axis : axes) {
      at[axis] = number % sizes[axis];
      number /= sizes[axis];
    }
    return at;
  }
  [[nodiscard]] std::uint64_t number(const std::array<std::uint64_t, 3>& at) const {
    std::uint64_t result = 0;
    for (std::size_t i = 3; i-- > 0;) result = result * sizes[axes[i]] + at[axes[i]];
    return result;
  }
};

/// State of the conversion of all images of a file.
struct OmeWork {
  std::size_t page_count = 0, next = 0, missing = 0;
  std::uint64_t left = 8 * kMostPlanes;  // steps
};

std::optional<TiffImage> image_of(const OmePixels& pixels, OmeWork& work) {
  TiffImage image;
  image.described = true;
  std::uint64_t samples = 1;  // that a page has of each pixel
  for (const auto& channel : pixels.channels) samples = std::max(samples, channel.second);
  image.times = pixels.t;
  image.slices = pixels.z;
  image.channels = std::max<std::uint64_t>(pixels.c / samples, 1);
  for (const std::uint64_t size : {image.times, image.slices, image.channels})
    if (size > kMostPlanes) return std::nullopt;
  const std::uint64_t planes = image.times * image.slices;
  if (planes > kMostPlanes || planes * image.channels > kMostPlanes) return std::nullopt;
  OmeOrder order{{image.slices, image.channels, image.times}, {0, 1, 2}};
  std::size_t rank = 0;
  for (const char letter : std::string_view(pixels.order).substr(2))
    if (const std::size_t axis = std::string_view("ZCT").find(letter); axis < 3 && rank < 3) order.axes[rank++] = axis;
  if (order.axes[0] == order.axes[1] || order.axes[1] == order.axes[2] || order.axes[0] == order.axes[2])
    return std::nullopt;
  const std::uint64_t all = planes * image.channels;
  if (all > work.left) return std::nullopt;
  work.left -= all;
  image.pages.assign(all, TiffImage::kNoPage);
  const auto set = [&](std::uint64_t number, std::uint64_t page) {
    const auto [z, c, t] = order.place(number);
    if (number < all && page < work.page_count)
      image.pages[(t * image.slices + z) * image.channels + c] = static_cast<std::uint32_t>(page);
  };
  std::vector<OmePlanes> blocks = pixels.planes;
  if (blocks.empty()) blocks.push_back({work.next, 0, 0, 0, all, false});
  for (const OmePlanes& block : blocks) {
    if (block.z >= image.slices || block.c >= image.channels || block.t >= image.times) continue;
    const std::uint64_t first = order.number({block.z, block.c, block.t});
    const std::uint64_t count = std::min(block.count.value_or(all), all - first);
    if (block.elsewhere) {
      work.missing += count;
      continue;
    }
    for (std::uint64_t i = 0; i < count && block.first + i < work.page_count && work.left > 0; ++i, --work.left)
      set(first + i, block.first + i);
  }
  work.next += all;
  if (std::ranges::all_of(image.pages, [](std::uint32_t page) { return page == TiffImage::kNoPage; }))
    return std::nullopt;
  const double x = pixels.sizes[0] > 0 ? pixels.sizes[0] : 1;
  image.spacing_x = x;
  image.spacing_y = pixels.sizes[1] > 0 ? pixels.sizes[1] : x;
  image.spacing_z = pixels.sizes[2] > 0 ? pixels.sizes[2] : x;
  if (pixels.sizes[0] > 0) image.unit = pixels.units[0];
  image.time_step = pixels.time_step;
  image.time_unit = pixels.time_unit;
  for (const auto& channel : pixels.channels) image.channel_names.push_back(channel.first);
  return image;
}

}  // namespace

std::vector<TiffImage> ome_images(std::string_view xml, std::size_t page_count, std::string_view file_name,
                                  std::size_t& missing) {
  std::vector<TiffImage> images;
  const std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr),
                                                                                             XML_ParserFree);
  if (!parser || xml.size() > (std::size_t{1} << 30)) return images;
  OmeParse parse;
  parse.file_name = file_name;
  XML_SetUserData(parser.get(), &parse);
  XML_SetElementHandler(parser.get(), begin_ome, [](void*, const XML_Char*) {});
  (void)XML_Parse(parser.get(), xml.data(), static_cast<int>(xml.size()), 1);
  OmeWork work;
  work.page_count = page_count;
  for (const OmePixels& pixels : parse.images)
    if (auto image = image_of(pixels, work)) images.push_back(std::move(*image));
  missing = work.missing;
  return images;
}

}  // namespace gs::app
