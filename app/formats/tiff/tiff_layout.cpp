#include "app/formats/tiff/tiff_layout.h"

#include "app/formats/common/text_cursor.h"
#include "base/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace gs::app {
namespace {

/// Value of a line such as "spacing=0.125" in the description of ImageJ.
std::string_view imagej_value(std::string_view description, std::string_view key) {
  while (!description.empty()) {
    const std::size_t end = std::min(description.find('\n'), description.size());
    const std::string_view line = trimmed(description.substr(0, end));
    if (line.size() > key.size() && line.starts_with(key) && line[key.size()] == '=')
      return line.substr(key.size() + 1);
    description.remove_prefix(std::min(end + 1, description.size()));
  }
  return {};
}

double tiff_number(std::string_view text, double otherwise) {
  double value = otherwise;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  return read.ec == std::errc() && std::isfinite(value) ? value : otherwise;
}

std::uint64_t count_in(std::string_view description, std::string_view key) {
  constexpr double kMost = 1e6;
  const double value = tiff_number(imagej_value(description, key), 1);
  return value >= 1 && value <= kMost ? static_cast<std::uint64_t>(value) : 1;
}

double positive(double value) { return value > 0 && value < 1e12 ? value : 1; }

/// Planes in the order of ImageJ: channels, then slices, then times.
TiffImage imagej_image(std::string_view description, std::size_t count, const std::vector<double>& resolution) {
  TiffImage image;
  image.described = true;
  image.channels = count_in(description, "channels");
  image.slices = count_in(description, "slices");
  image.times = count_in(description, "frames");
  const double planes =
      static_cast<double>(image.channels) * static_cast<double>(image.slices) * static_cast<double>(image.times);
  if (planes != static_cast<double>(count)) {  // a stack without axes, or a cut file
    image.channels = image.times = 1;
    image.slices = count;
  }
  image.pages.resize(count);
  std::iota(image.pages.begin(), image.pages.end(), 0u);
  image.unit = plain_unit(imagej_value(description, "unit"));
  if (resolution.size() == 3 && !image.unit.empty()) {
    image.spacing_x = positive(1 / resolution[0]);
    image.spacing_y = positive(1 / resolution[1]);
  }
  // Without a distance of slices, voxels are as deep as wide.
  image.spacing_z = std::abs(tiff_number(imagej_value(description, "spacing"), image.spacing_x));
  if (image.spacing_z == 0) image.spacing_z = image.spacing_x;
  image.time_step = positive(tiff_number(imagej_value(description, "finterval"), 1));
  image.time_unit = image.times > 1 ? "s" : "";
  return image;
}

/// Returns the numbers or the text of a member of a JSON object as tifffile writes it: {"shape": [2, 3], "axes":
/// "ZYX"}.
std::string_view json_member(std::string_view text, std::string_view key) {
  const std::string quoted = '"' + std::string(key) + "\":";
  const std::size_t at = text.find(quoted);
  if (at == std::string_view::npos) return {};
  text = trimmed(text.substr(at + quoted.size()));
  if (text.starts_with('[')) return text.substr(1, text.find(']') - 1);
  if (text.starts_with('"')) return text.substr(1, text.find('"', 1) - 1);
  return {};
}

/// Planes of tifffile. Its description has the shape, and perhaps the names of the axes.
std::optional<TiffImage> shaped_image(std::string_view description, std::size_t count) {
  std::string_view numbers = json_member(description, "shape"), axes = json_member(description, "axes");
  std::vector<std::uint64_t> shape;
  while (!numbers.empty() && shape.size() < 8) {
    const std::size_t end = std::min(numbers.find(','), numbers.size());
    shape.push_back(static_cast<std::uint64_t>(std::max(0.0, tiff_number(trimmed(numbers.substr(0, end)), 0))));
    numbers.remove_prefix(std::min(end + 1, numbers.size()));
  }
  if (axes.size() != shape.size() || shape.empty()) return std::nullopt;
  TiffImage image;
  image.described = true;
  std::vector<std::pair<char, std::uint64_t>> outer;  // axes of pages, the slowest first
  for (std::size_t i = 0; i < axes.size(); ++i)
    if (axes[i] != 'Y' && axes[i] != 'X' && axes[i] != 'S') outer.emplace_back(axes[i], shape[i]);
  std::uint64_t planes = 1;
  for (const auto& [axis, size] : outer) {
    if (size == 0 || size > count || planes > count) return std::nullopt;
    planes *= size;
    (axis == 'T' ? image.times : axis == 'C' ? image.channels : image.slices) *= size;
  }
  if (planes != count) return std::nullopt;
  image.pages.resize(count);
  for (std::uint32_t page = 0; page < count; ++page) {
    std::uint64_t rest = page, time = 0, slice = 0, channel = 0, times = 1, slices = 1, channels = 1;
    for (auto axis = outer.rbegin(); axis != outer.rend(); ++axis) {
      const std::uint64_t index = rest % axis->second;
      rest /= axis->second;
      std::uint64_t& place = axis->first == 'T' ? time : axis->first == 'C' ? channel : slice;
      std::uint64_t& size = axis->first == 'T' ? times : axis->first == 'C' ? channels : slices;
      place += index * size;
      size *= axis->second;
    }
    image.pages[(time * image.slices + slice) * image.channels + channel] = page;
  }
  return image;
}

TiffImage stack(std::size_t count) {
  TiffImage image;
  image.slices = count;
  image.pages.resize(count);
  std::iota(image.pages.begin(), image.pages.end(), 0u);
  return image;
}

const ArrayAttribute* named(const std::vector<ArrayAttribute>& attributes, std::string_view name) {
  const auto found = std::ranges::find(attributes, name, &ArrayAttribute::name);
  return found == attributes.end() ? nullptr : &*found;
}

/// Place of a page of the file: its array, and its number there.
struct PagePlace {
  std::uint32_t array = TiffImage::kNoPage, index = 0;
};

/// Turns the pages of the file into those of the array that has the first of them. Returns false if none has.
bool move_to_array(const std::vector<PagePlace>& places, TiffImage& image) {
  std::uint32_t array = TiffImage::kNoPage;
  for (std::uint32_t& page : image.pages) {
    if (page == TiffImage::kNoPage) continue;
    const PagePlace place = page < places.size() ? places[page] : PagePlace{};
    if (array == TiffImage::kNoPage) array = place.array;
    page = place.array == array && array != TiffImage::kNoPage ? place.index : TiffImage::kNoPage;
  }
  image.array = array;
  return array != TiffImage::kNoPage;
}

}  // namespace

std::string plain_unit(std::string_view unit) {
  unit = trimmed(unit);
  if (unit.size() > 32) return {};
  const std::string name = lower_case(unit);
  static constexpr std::pair<std::string_view, std::string_view> kUnits[] = {
      {"\\u00b5m", "um"},   {"\xc2\xb5m", "um"},    {"\xce\xbcm", "um"},      {"\xb5m", "um"},
      {"micron", "um"},     {"microns", "um"},      {"micrometer", "um"},     {"micrometre", "um"},
      {"um", "um"},         {"nanometer", "nm"},    {"nanometre", "nm"},      {"millimeter", "mm"},
      {"millimetre", "mm"}, {"centimeter", "cm"},   {"meter", "m"},           {"\xc2\xb5s", "us"},
      {"\xce\xbcs", "us"},  {"sec", "s"},           {"\xc3\x85", "angstrom"}, {"pixel", ""},
      {"pixels", ""},       {"reference frame", ""}};
  if (const auto known = value_named(kUnits, name)) return std::string(*known);
  for (const char c : unit)
    if (c <= ' ' || c > '~') return {};
  return std::string(unit);
}

std::vector<TiffImage> tiff_images(ArrayFile& pages, std::string_view file_name, std::size_t& missing) {
  std::vector<TiffImage> images;
  constexpr std::size_t kMostPages = 1'000'000;
  std::vector<PagePlace> places;  // of each page of the file
  for (std::size_t i = 0; i < pages.arrays().size(); ++i) {
    const ArrayInfo& array = pages.arrays()[i];
    const std::vector<ArrayAttribute> attributes = pages.attributes(array.path);
    const ArrayAttribute* numbers = named(attributes, "pages");
    for (std::uint32_t index = 0; numbers && index < numbers->numbers.size(); ++index) {
      const auto page = static_cast<std::size_t>(numbers->numbers[index]);
      if (page >= kMostPages) continue;
      if (page >= places.size()) places.resize(page + 1);
      places[page] = {static_cast<std::uint32_t>(i), index};
    }
  }
  for (std::size_t i = 0; i < pages.arrays().size(); ++i) {
    const ArrayInfo& array = pages.arrays()[i];
    const std::vector<ArrayAttribute> attributes = pages.attributes(array.path);
    const std::size_t count = array.shape[0];
    const ArrayAttribute* text = named(attributes, "description");
    const std::string_view description = text && !text->texts.empty() ? std::string_view(text->texts[0]) : "";
    if (i == 0 && description.find("<OME") != std::string_view::npos) {
      images = ome_images(description, places.size(), file_name, missing);
      std::erase_if(images, [&](TiffImage& image) { return !move_to_array(places, image); });
      if (!images.empty()) return images;
    }
    const ArrayAttribute* resolution = named(attributes, "resolution");
    TiffImage image;
    if (description.starts_with("ImageJ="))
      image = imagej_image(description, count, resolution ? resolution->numbers : std::vector<double>());
    else
      image = shaped_image(description, count).value_or(stack(count));
    image.array = i;
    images.push_back(std::move(image));
  }
  return images;
}

}  // namespace gs::app
