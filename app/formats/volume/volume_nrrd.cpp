#include "app/formats/common/text_cursor.h"
#include "app/formats/volume/volume_common.h"
#include "qnv/container/step_table.h"
#include "qnv/container/value_grid.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

// Reader of NRRD: https://teem.sourceforge.net/nrrd/format.html

namespace gs::app {
namespace {

/// Header fields that this reader supports, unparsed.
struct NrrdHeader {
  std::string type, encoding = "raw", endian, data_file, sizes, spacings, axis_mins, directions, origin, kinds, times;
  double dimension = 0, line_skip = 0, byte_skip = 0;
  bool detached = false;
  std::size_t size = 0;  // size of the header in bytes, with the blank line at its end
};

std::optional<StoredType> nrrd_type_of(std::string_view name) {
  struct Name {
    std::string_view names;
    StoredType type;
  };
  static constexpr Name kNames[] = {
      {"|signed char|int8|int8_t|", StoredType::i8},
      {"|uchar|unsigned char|uint8|uint8_t|", StoredType::u8},
      {"|short|short int|signed short|signed short int|int16|int16_t|", StoredType::i16},
      {"|ushort|unsigned short|unsigned short int|uint16|uint16_t|", StoredType::u16},
      {"|int|signed int|int32|int32_t|", StoredType::i32},
      {"|uint|unsigned int|uint32|uint32_t|", StoredType::u32},
      {"|longlong|long long|long long int|signed long long|signed long long int|int64|int64_t|", StoredType::i64},
      {"|ulonglong|unsigned long long|unsigned long long int|uint64|uint64_t|", StoredType::u64},
      {"|float|", StoredType::f32},
      {"|double|", StoredType::f64}};
  const std::string key = '|' + std::string(name) + '|';
  for (const Name& entry : kNames)
    if (entry.names.find(key) != std::string_view::npos) return entry.type;
  return std::nullopt;
}

void read_field(std::string_view name, std::string_view value, NrrdHeader& header, qnv::VolumeLayout& layout) {
  const auto number = [&] {
    const std::vector<double> numbers = numbers_of(value, 1);
    return numbers.empty() ? 0.0 : numbers[0];
  };
  const std::string key = lower_case(name);
  if (key == "type") header.type = lower_case(value);
  if (key == "encoding") header.encoding = lower_case(value);
  if (key == "endian") header.endian = lower_case(value);
  if (key == "sizes") header.sizes = value;
  if (key == "spacings") header.spacings = value;
  if (key == "axis mins" || key == "axismins") header.axis_mins = value;
  if (key == "space directions") header.directions = value;
  if (key == "space origin") header.origin = value;
  if (key == "kinds") header.kinds = lower_case(value);
  if (key == "dimension") header.dimension = number();
  if (key == "line skip" || key == "lineskip") header.line_skip = number();
  if (key == "byte skip" || key == "byteskip") header.byte_skip = number();
  if (key == "data file" || key == "datafile") {
    header.data_file = value;
    header.detached = true;
  }
  // "content" may be a title. If it has parentheses, a tool has written the processing history: "crop(tooth,[51,153])".
  if (key == "content") add_metadata(layout, value.find('(') == std::string_view::npos ? "title" : "content", value);
  if (key == "space" || key == "space units" || key == "sample units") add_metadata(layout, key, value);
}

NrrdHeader read_nrrd_header(std::span<const std::byte> bytes, qnv::VolumeLayout& layout) {
  NrrdHeader header;
  constexpr std::size_t kMaxHeader = std::size_t{1} << 20;
  TextCursor cursor(bytes.first(std::min(bytes.size(), kMaxHeader)));
  const char* begin = cursor.next;
  (void)cursor.line();
  while (!cursor.at_end()) {
    const std::string_view line = cursor.line();
    if (line.empty()) break;
    if (line.front() == '#') continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos || colon + 1 == line.size()) continue;
    if (line[colon + 1] == '=') {
      // 3D Slicer describes the segments of a segmentation.
      if (line.substr(0, colon) == "Segment0_LabelValue") layout.labels = true;
      if (line.substr(0, colon) == "times")
        header.times = line.substr(colon + 2);
      else
        add_metadata(layout, line.substr(0, colon), line.substr(colon + 2));
    } else
      read_field(trimmed(line.substr(0, colon)), trimmed(line.substr(colon + 1)), header, layout);
  }
  header.size = static_cast<std::size_t>(cursor.next - begin);
  return header;
}

/// Parses vectors of the form "(a,b,c)", one per axis. "none" becomes nullopt.
std::vector<std::optional<glm::vec3>> vectors_of(std::string_view text) {
  std::vector<std::optional<glm::vec3>> vectors;
  TextCursor cursor(text.data(), text.data() + text.size());
  while (cursor.skip_space() && vectors.size() < 16) {
    const char* first = cursor.next;
    if (*first != '(') {
      (void)cursor.word();
      vectors.emplace_back();
      continue;
    }
    while (!cursor.at_end() && *cursor.next != ')') ++cursor.next;
    const std::vector<double> numbers = numbers_of({first, static_cast<std::size_t>(cursor.next - first)}, 3);
    if (!cursor.at_end()) ++cursor.next;
    glm::vec3 vector(0);
    for (std::size_t i = 0; i < numbers.size(); ++i) vector[static_cast<int>(i)] = static_cast<float>(numbers[i]);
    vectors.emplace_back(vector);
  }
  return vectors;
}

/// Roles of the axes. Up to three are spatial. Of four or more axes, one may hold the components of a voxel.
struct NrrdAxes {
  std::vector<std::size_t> spatial;
  std::vector<double> sizes;  // sizes of the spatial axes
  std::uint64_t components = 1;
  bool colors = false;              // of the components
  std::optional<std::size_t> time;  // the only axis after the spatial ones that has several samples
  double skipped = 1;               // size of the largest unused axis after the first spatial axis
};

std::variant<NrrdAxes, std::string> axes_of(const NrrdHeader& header) {
  constexpr std::size_t kMaxAxes = 16;
  constexpr double kMaxComponents = 4096;
  const std::vector<double> sizes = numbers_of(header.sizes, kMaxAxes);
  if (sizes.empty() || header.dimension != static_cast<double>(sizes.size()))
    return "'dimension' and 'sizes: " + header.sizes.substr(0, 80) + "' do not match";
  const auto vectors = vectors_of(header.directions);
  std::vector<std::string_view> kinds;
  TextCursor words(header.kinds.data(), header.kinds.data() + header.kinds.size());
  while (words.skip_space()) kinds.push_back(words.word());
  std::vector<bool> spatial(sizes.size(), true);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const bool none = vectors.size() == sizes.size() && !vectors[i];
    const bool known = kinds.size() == sizes.size() && kinds[i] != "???" && kinds[i] != "none";
    spatial[i] = !none && !(known && kinds[i] != "space" && kinds[i] != "domain");
  }
  // Without kinds: the last axis is time if the first one is too long for the components of a voxel.
  if (kinds.empty() && vectors.size() != sizes.size() && sizes.size() == 4 && sizes[0] > qnv::kMaxValueComponents)
    spatial[3] = false;
  // Without kinds: an axis with one sample is not spatial, and the components of a voxel vary fastest.
  for (const bool any_size : {false, true})
    for (std::size_t i = 0; i < sizes.size() && std::count(spatial.begin(), spatial.end(), true) > 3; ++i)
      if (any_size || sizes[i] == 1) spatial[i] = false;
  NrrdAxes axes;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (spatial[i]) {
      if (!axes.spatial.empty() && axes.skipped > 1) return std::string("a non-spatial axis is between spatial axes");
      axes.spatial.push_back(i);
      axes.sizes.push_back(sizes[i]);
    } else if (axes.spatial.empty()) {
      if (!(sizes[i] >= 1 && sizes[i] <= kMaxComponents) || sizes[i] != std::floor(sizes[i]))
        return "'sizes' has '" + header.sizes.substr(0, 80) + "'; expected 1 to 4096 components per voxel";
      axes.components *= static_cast<std::uint64_t>(sizes[i]);
      const std::string_view kind = kinds.size() == sizes.size() ? kinds[i] : std::string_view();
      axes.colors = kind == "rgb-color" || kind == "rgba-color" || kind == "3-color" || kind == "4-color";
      if (axes.components > static_cast<std::uint64_t>(kMaxComponents))
        return std::string("more than 4096 components per voxel");
    } else {
      if (sizes[i] > 1) axes.time = axes.skipped > 1 ? std::nullopt : std::optional(i);
      axes.skipped = std::max(axes.skipped, sizes[i]);
    }
  }
  if (axes.spatial.size() > 3 || axes.spatial.empty())
    return std::to_string(axes.spatial.size()) + " spatial axes; expected 1 to 3";
  return axes;
}

void place(const NrrdHeader& header, const NrrdAxes& axes, qnv::VolumeLayout& layout) {
  const auto vectors = vectors_of(header.directions);
  const std::vector<double> spacings = numbers_of(header.spacings, 16), mins = numbers_of(header.axis_mins, 16);
  for (std::size_t i = 0; i < axes.spatial.size(); ++i) {
    const std::size_t axis = axes.spatial[i];
    const int along = static_cast<int>(i);
    if (axis < vectors.size() && vectors[axis])
      layout.axes[i] = *vectors[axis];
    else if (axis < spacings.size() && std::isfinite(spacings[axis]) && spacings[axis] != 0)
      layout.axes[i] *= static_cast<float>(spacings[axis]);
    if (axis < mins.size() && header.origin.empty()) layout.origin[along] = mins[axis];
  }
  const std::vector<double> origin = numbers_of(header.origin, 3);
  for (std::size_t i = 0; i < origin.size(); ++i) layout.origin[static_cast<int>(i)] = origin[i];
}

/// Returns the times of the steps; empty without steps.
std::vector<double> times_of(const NrrdHeader& header, const NrrdAxes& axes) {
  if (!axes.time) return {};
  const std::vector<double> sizes = numbers_of(header.sizes, 16), spacings = numbers_of(header.spacings, 16),
                            mins = numbers_of(header.axis_mins, 16);
  const double count = sizes[*axes.time];
  if (!(count >= 2 && count <= static_cast<double>(qnv::kMaxSteps)) || count != std::floor(count)) return {};
  const auto number = [&](const std::vector<double>& from, double otherwise) {
    return from.size() == sizes.size() && std::isfinite(from[*axes.time]) ? from[*axes.time] : otherwise;
  };
  const double first = number(mins, 0), given = number(spacings, 1), apart = given > 0 ? given : 1;
  // Our exports state times with unequal distances.
  std::vector<double> times = numbers_of(header.times, qnv::kMaxSteps);
  if (static_cast<double>(times.size()) == count &&
      std::ranges::adjacent_find(times, std::greater_equal<>()) == times.end())
    return times;
  times.clear();
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    times.push_back(first + apart * static_cast<double>(i));
  return times;
}

/// Returns the voxels after the header and skipped lines, decompressed.
std::variant<StoredVoxels, std::string> voxels_of(const VolumeFile& file, const NrrdHeader& header, StoredType type,
                                                  std::uint64_t size, std::uint64_t count) {
  StoredVoxels voxels;
  voxels.type = type;
  voxels.content = file.content;
  std::size_t begin = header.size;
  if (header.detached) {
    if (lower_case(header.data_file).starts_with("list") || header.data_file.find('%') != std::string::npos)
      return std::string(
          "the data is in a list of files; expected one data file (join them, for example with `unu save`)");
    BytesResult loaded = load_beside(file, header.data_file);
    if (auto* problem = std::get_if<std::string>(&loaded)) return std::move(*problem);
    voxels.content = std::get<SharedBytes>(std::move(loaded));
    begin = 0;
  }
  std::span<const std::byte> data = voxels.content.bytes.subspan(begin);
  TextCursor lines(data);
  for (double i = 0; i < header.line_skip && !lines.at_end(); ++i) (void)lines.line();
  data = data.last(static_cast<std::size_t>(lines.end - lines.next));
  const bool from_end = header.byte_skip == -1 && header.encoding == "raw";
  if (!from_end && !(header.byte_skip >= 0 && header.byte_skip < 1e15))
    return std::string("'byte skip' is not a number of bytes");
  const auto skip = from_end ? data.size() - std::min<std::uint64_t>(size, data.size())
                             : static_cast<std::uint64_t>(header.byte_skip);
  if (header.encoding == "raw") {
    voxels.offset = voxels.content.bytes.size() - data.size() + skip;
  } else if (header.encoding == "gzip" || header.encoding == "gz") {
    // If a separate file is gzip-compressed as a whole, load_beside() has already decompressed it.
    BytesResult unpacked = SharedBytes{voxels.content.owner, data};
    const bool packed = data.size() >= 2 && data[0] == std::byte{0x1f} && data[1] == std::byte{0x8b};
    if (packed || !header.detached) unpacked = unpacked_exactly(data, size + skip, file.budget);
    if (auto* problem = std::get_if<std::string>(&unpacked)) return std::move(*problem);
    voxels.content = std::get<SharedBytes>(std::move(unpacked));
    voxels.offset = skip;
  } else if (header.encoding == "ascii" || header.encoding == "txt" || header.encoding == "text") {
    return voxels_of_text(data.subspan(std::min<std::uint64_t>(skip, data.size())), count, type, file.budget);
  } else {
    return "the encoding is '" + header.encoding.substr(0, 80) + "'; expected raw, gzip or ascii";
  }
  return voxels;
}

}  // namespace

bool is_nrrd(std::span<const std::byte> bytes) { return text_of(bytes).starts_with("NRRD000"); }

bool is_detached_nrrd(std::span<const std::byte> bytes) {
  qnv::VolumeLayout layout;
  return is_nrrd(bytes) && read_nrrd_header(bytes, layout).detached;
}

bool is_plain_nrrd(std::span<const std::byte> bytes) {
  const std::string_view text = text_of(bytes);
  if (!is_nrrd(bytes) || (text.find("\n\n") == text.npos && text.find("\r\n\r\n") == text.npos)) return false;
  qnv::VolumeLayout layout;
  const NrrdHeader header = read_nrrd_header(bytes, layout);
  return !header.detached && header.encoding == "raw" && header.line_skip == 0;
}

VolumeResult open_nrrd(const VolumeFile& file) {
  if (!is_nrrd(file.content.bytes)) return std::string("the file does not begin with NRRD000");
  qnv::VolumeLayout layout;
  const NrrdHeader header = read_nrrd_header(file.content.bytes, layout);
  const std::optional<StoredType> type = nrrd_type_of(header.type);
  if (!type) return "the type is '" + header.type.substr(0, 80) + "'; expected an integer or float type";
  auto found = axes_of(header);
  if (auto* problem = std::get_if<std::string>(&found)) return std::move(*problem);
  const NrrdAxes& axes = std::get<NrrdAxes>(found);
  const auto dimensions = dimensions_of(axes.sizes);
  if (!dimensions) return "the sizes are '" + header.sizes.substr(0, 80) + "'; expected whole numbers above 0";
  layout.dimensions = *dimensions;
  layout.colors = axes.colors;
  place(header, axes, layout);
  const auto size = stored_size(layout, *type, axes.components);
  if (const auto* problem = std::get_if<std::string>(&size)) return *problem;
  const std::vector<double> times = times_of(header, axes);
  const std::uint64_t bytes = std::get<std::uint64_t>(size) * std::max<std::size_t>(times.size(), 1);
  auto voxels = voxels_of(file, header, *type, bytes, bytes / size_of(*type));
  if (auto* problem = std::get_if<std::string>(&voxels)) return std::move(*problem);
  StoredVoxels& stored = std::get<StoredVoxels>(voxels);
  if (header.encoding.starts_with("raw") || header.encoding.starts_with("gz"))
    stored.big_endian = header.endian == "big";
  stored.components = axes.components;
  stored.component = file.component;
  return make_series(layout, stored, times);
}

}  // namespace gs::app
