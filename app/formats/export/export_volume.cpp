#include "app/formats/export/export_volume.h"

#include "app/formats/export/volume_values_writer.h"
#include "base/bytes.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <zlib.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <span>
#include <utility>

namespace gs::app {
namespace {

using qnv::VoxelType;

/// Names and codes of a voxel type in the formats.
struct VoxelTypeName {
  const char *nrrd, *vtk;
  std::int16_t nifti;
  int fits;
};
constexpr std::array<VoxelTypeName, 8> kVoxelTypeNames{{{"uint8", "UInt8", 2, 8},
                                                        {"int8", "Int8", 256, 0},
                                                        {"uint16", "UInt16", 512, 0},
                                                        {"int16", "Int16", 4, 16},
                                                        {"uint32", "UInt32", 768, 0},
                                                        {"int32", "Int32", 8, 32},
                                                        {"float", "Float32", 16, -32},
                                                        {"double", "Float64", 64, -64}}};
const VoxelTypeName& names_of(VoxelType type) { return kVoxelTypeNames[static_cast<std::size_t>(type)]; }

std::string shortest(double value) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

// Returns the metadata value of a key, or an empty string if the key is absent.
std::string metadata_value(const qnv::VolumeLayout& layout, std::string_view key) {
  for (const auto& [name, value] : layout.metadata)
    if (name == key) return value;
  return {};
}

bool fits_one_line(const std::string& text) {
  return std::ranges::none_of(text, [](char c) { return static_cast<unsigned char>(c) < 32; });
}

using Written = std::optional<std::string>;

// Passes on a text.
bool take_text(const TakeBytes& take, const std::string& text) { return take(std::as_bytes(std::span(text))); }

// Writes a head, the voxels, and a tail.
Written write_all(const std::string& head, const WrittenVoxels& voxels, const std::string& tail,
                  const TakeBytes& take) {
  if (!take_text(take, head)) return std::string();
  if (auto problem = voxels.write(take)) return problem;
  return tail.empty() || take_text(take, tail) ? std::nullopt : Written(std::string());
}

// Returns the bytes of a file that is written in pieces.
Exported collected(VolumeWriter write, const qnv::Geometry& geometry, const ExportOptions& options) {
  std::vector<std::byte> bytes;
  auto problem = write(geometry, options, [&](std::span<const std::byte> piece) {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
    return true;
  });
  if (problem) return std::move(*problem);
  return bytes;
}

// NIfTI has the first time and one distance.
Written refuse_uneven(const std::vector<double>& times) {
  for (std::size_t i = 2; i < times.size(); ++i)
    if (const double apart = times[1] - times[0]; std::abs(times[i] - times[i - 1] - apart) > 1e-5 * apart)
      return std::string("the times of the steps have unequal distances, which NIfTI cannot hold; expected .nrrd");
  return std::nullopt;
}

Written refuse_steps(const WrittenVoxels& voxels, const char* format) {
  if (voxels.times().empty()) return std::nullopt;
  return std::string(format) + " holds one volume; expected --time with one step, or .nrrd or .nii";
}

Written nifti_bytes(const qnv::Geometry& geometry, const ExportOptions& options, const TakeBytes& take) {
  auto made = WrittenVoxels::of(geometry, {.planes = true});
  if (auto* problem = std::get_if<std::string>(&made)) return std::move(*problem);
  const auto& voxels = std::get<WrittenVoxels>(made);
  const qnv::VolumeLayout& layout = voxels.layout();
  if (std::ranges::any_of(layout.dimensions, [](std::uint32_t n) { return n > 32767; }))
    return std::string("NIfTI-1 holds at most 32767 voxels per axis; expected .nrrd or .vti");
  std::vector<std::byte> out;
  ByteWriter write(out);
  const auto zeros = [&](std::size_t count) { out.resize(out.size() + count, std::byte{0}); };
  const auto text = [&](const std::string& value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i)
      out.push_back(static_cast<std::byte>(i + 1 < size && i < value.size() ? value[i] : '\0'));
  };
  write.integer(std::int32_t{348});
  zeros(36);
  const bool colors = voxels.colors();
  const int numbers = colors ? 1 : static_cast<int>(voxels.components());
  const std::vector<double>& times = voxels.times();
  if (const auto problem = refuse_uneven(times)) return *problem;
  for (const int n : {numbers > 1      ? 5
                      : !times.empty() ? 4
                                       : 3,
                      static_cast<int>(layout.dimensions[0]), static_cast<int>(layout.dimensions[1]),
                      static_cast<int>(layout.dimensions[2]), static_cast<int>(std::max<std::size_t>(times.size(), 1)),
                      numbers, 1, 1})
    write.integer(static_cast<std::int16_t>(n));
  zeros(12);  // parameters of the intent
  write.integer(std::int16_t{static_cast<std::int16_t>(numbers > 1     ? 1007
                                                       : layout.labels ? 1002
                                                                       : 0)});  // _VECTOR, _LABEL
  constexpr std::int16_t kRgb = 128, kRgba = 2304;
  write.integer(!colors ? names_of(layout.type).nifti : voxels.components() == 3 ? kRgb : kRgba);
  write.integer(static_cast<std::int16_t>(8 * qnv::size_of(layout.type) * (colors ? voxels.components() : 1)));
  zeros(2);
  write.f32(1);
  for (const glm::vec3& axis : layout.axes) write.f32(glm::length(axis));
  write.f32(times.empty() ? 0 : static_cast<float>(times[1] - times[0]));
  zeros(12);
  constexpr float kDataOffset = 352;
  write.f32(kDataOffset);
  write.f32(static_cast<float>(layout.slope));
  write.f32(static_cast<float>(layout.intercept));
  zeros(3);
  write.integer(static_cast<std::uint8_t>(metadata_value(layout, "units") == "mm" ? 2 : 0));
  zeros(12);
  write.f32(times.empty() ? 0 : static_cast<float>(times[0]));
  zeros(8);
  text(options.title, 80);
  zeros(24);
  write.integer(std::int16_t{0});
  write.integer(std::int16_t{1});  // the affine transformation holds
  zeros(24);
  const glm::dvec3 origin = layout.base + layout.origin;
  for (int row = 0; row < 3; ++row) {
    for (const glm::vec3& axis : layout.axes) write.f32(axis[row]);
    write.f32(static_cast<float>(origin[row]));
  }
  zeros(16);
  for (const char c : {'n', '+', '1', '\0'}) out.push_back(static_cast<std::byte>(c));
  zeros(4);
  return take(out) ? voxels.write(take) : Written(std::string());
}

// One card of a FITS header (4.1).
std::string card(const std::string& keyword, const std::string& value, bool text = false) {
  std::string line = keyword;
  line.resize(8, ' ');
  line += "= ";
  if (text) {
    std::string quoted = "'";
    for (const char c : value)
      if (quoted.size() < 66 && c >= ' ' && c <= '~') quoted += c == '\'' ? std::string("''") : std::string(1, c);
    quoted.resize(std::max<std::size_t>(quoted.size(), 9), ' ');
    line += quoted + "'";
  } else {
    line += std::string(value.size() < 20 ? 20 - value.size() : 0, ' ') + value;
  }
  line.resize(80, ' ');
  return line;
}

// Number of FITS, which has an upper-case exponent and a decimal point.
std::string fits_number(double value) {
  std::string text = shortest(value);
  std::ranges::replace(text, 'e', 'E');
  if (text.find_first_of(".E") == std::string::npos) text += ".";
  return text;
}

}  // namespace

Written write_nrrd(const qnv::Geometry& geometry, const ExportOptions& options, const TakeBytes& take) {
  auto made = WrittenVoxels::of(geometry, {.scaled = false});
  if (auto* problem = std::get_if<std::string>(&made)) return std::move(*problem);
  const auto& voxels = std::get<WrittenVoxels>(made);
  const qnv::VolumeLayout& layout = voxels.layout();
  const auto vector = [](const glm::dvec3& v) {
    return "(" + shortest(v.x) + "," + shortest(v.y) + "," + shortest(v.z) + ")";
  };
  std::string head = "NRRD0004\n";
  if (!options.title.empty() && fits_one_line(options.title)) head += "content: " + options.title + "\n";
  const bool several = voxels.components() > 1;
  const std::vector<double>& times = voxels.times();
  const bool moves = !times.empty();
  head += std::string("type: ") + names_of(layout.type).nrrd +
          "\ndimension: " + std::to_string(3 + (several ? 1 : 0) + (moves ? 1 : 0)) +
          "\nspace dimension: 3\nsizes:" + (several ? " " + std::to_string(voxels.components()) : "");
  for (const std::uint32_t n : layout.dimensions) head += " " + std::to_string(n);
  if (moves) head += " " + std::to_string(times.size());
  head += std::string("\nspace directions:") + (several ? " none" : "");
  for (const glm::vec3& axis : layout.axes) {
    std::array<std::string, 3> parts;
    for (int i = 0; i < 3; ++i) {
      std::array<char, 32> text;
      parts[static_cast<std::size_t>(i)] =
          std::string(text.data(), std::to_chars(text.data(), text.data() + text.size(), axis[i]).ptr);
    }
    head += " (" + parts[0] + "," + parts[1] + "," + parts[2] + ")";
  }
  if (moves) {
    const std::string others = several ? " nan nan nan nan " : " nan nan nan ";
    head += " none\nspacings:" + others + shortest(times[1] - times[0]) + "\naxis mins:" + others + shortest(times[0]);
  }
  head += "\nspace origin: " + vector(layout.base + layout.origin) + "\nkinds: " +
          (!several                   ? ""
           : !voxels.colors()         ? "list "
           : voxels.components() == 3 ? "RGB-color "
                                      : "RGBA-color ") +
          "domain domain domain" + (moves ? " time" : "") + "\n";
  if (refuse_uneven(times)) {
    head += "times:=";
    for (const double time : times) head += shortest(time) + " ";
    head += "\n";
  }
  if (const std::string units = metadata_value(layout, "units");
      !units.empty() && fits_one_line(units) && units.find('"') == std::string::npos)
    head += "space units: \"" + units + "\" \"" + units + "\" \"" + units + "\"\n";
  if (qnv::size_of(layout.type) > 1) head += "endian: little\n";
  return write_all(head + "encoding: raw\n\n", voxels, {}, take);
}

Written write_vti(const qnv::Geometry& geometry, const ExportOptions&, const TakeBytes& take) {
  auto made = WrittenVoxels::of(geometry, {.scaled = false});
  if (auto* problem = std::get_if<std::string>(&made)) return std::move(*problem);
  const auto& voxels = std::get<WrittenVoxels>(made);
  if (auto problem = refuse_steps(voxels, ".vti")) return problem;
  const qnv::VolumeLayout& layout = voxels.layout();
  std::array<glm::dvec3, 3> directions;
  std::string spacing, direction, extent;
  for (std::size_t i = 0; i < 3; ++i) {
    const double length = glm::length(glm::dvec3(layout.axes[i]));
    directions[i] = glm::dvec3(layout.axes[i]) / length;
    spacing += (i > 0 ? " " : "") + shortest(length);
    extent += (i > 0 ? " 0 " : "0 ") + std::to_string(layout.dimensions[i] - 1);
  }
  for (std::size_t i = 0; i < 3; ++i)
    if (std::abs(glm::dot(directions[i], directions[(i + 1) % 3])) > 1e-4)
      return std::string("the axes are not at right angles, which .vti needs; expected .nrrd or .nii");
  for (int row = 0; row < 3; ++row)
    for (std::size_t i = 0; i < 3; ++i) direction += (direction.empty() ? "" : " ") + shortest(directions[i][row]);
  const glm::dvec3 origin = layout.base + layout.origin;
  const std::string name = voxels.colors() ? "colors" : "values";
  const std::string head =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<ImageData WholeExtent=\"" +
      extent + "\" Origin=\"" + shortest(origin.x) + " " + shortest(origin.y) + " " + shortest(origin.z) +
      "\" Spacing=\"" + spacing + "\" Direction=\"" + direction + "\">\n<Piece Extent=\"" + extent +
      "\">\n<PointData Scalars=\"" + name + "\">\n<DataArray type=\"" + names_of(layout.type).vtk + "\" Name=\"" +
      name + "\" NumberOfComponents=\"" + std::to_string(voxels.components()) +
      "\" format=\"appended\" offset=\"0\"/>\n</PointData>\n</Piece>\n</ImageData>\n"
      "<AppendedData encoding=\"raw\">\n_";
  std::vector<std::byte> size;
  ByteWriter(size).integer(voxels.bytes());
  const std::string sized = head + std::string(reinterpret_cast<const char*>(size.data()), size.size());
  return write_all(sized, voxels, "\n</AppendedData>\n</VTKFile>\n", take);
}

Written write_nifti(const qnv::Geometry& geometry, const ExportOptions& options, const TakeBytes& take) {
  return nifti_bytes(geometry, options, take);
}

Written write_nifti_gz(const qnv::Geometry& geometry, const ExportOptions& options, const TakeBytes& take) {
  z_stream stream{};
  constexpr int kGzip = 15 + 16, kMemory = 8;
  if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    return std::string("not enough memory to compress");
  std::array<std::byte, 1 << 16> piece;
  bool failed = false;
  const auto compress = [&](std::span<const std::byte> bytes, int flush) {
    do {
      if (stream.avail_in == 0) {
        const auto next = bytes.first(std::min<std::size_t>(bytes.size(), std::numeric_limits<uInt>::max()));
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(next.data()));
        stream.avail_in = static_cast<uInt>(next.size());
        bytes = bytes.subspan(next.size());
      }
      stream.next_out = reinterpret_cast<Bytef*>(piece.data());
      stream.avail_out = static_cast<uInt>(piece.size());
      const int status = deflate(&stream, bytes.empty() ? flush : Z_NO_FLUSH);
      failed = status == Z_STREAM_ERROR;
      if (failed || !take(std::span(piece).first(piece.size() - stream.avail_out))) return false;
    } while (!bytes.empty() || stream.avail_in > 0 || stream.avail_out == 0);
    return true;
  };
  auto problem =
      nifti_bytes(geometry, options, [&](std::span<const std::byte> bytes) { return compress(bytes, Z_NO_FLUSH); });
  if (!problem && !compress({}, Z_FINISH)) problem = std::string();
  deflateEnd(&stream);
  if (failed) return std::string("gzip failed to compress the volume; expected .nii instead");
  return problem;
}

Written write_fits(const qnv::Geometry& geometry, const ExportOptions& options, const TakeBytes& take) {
  auto made = WrittenVoxels::of(geometry, {.big_endian = true, .fits_types = true});
  if (auto* problem = std::get_if<std::string>(&made)) return std::move(*problem);
  const auto& voxels = std::get<WrittenVoxels>(made);
  if (voxels.components() > 1)
    return std::string("FITS has one number per voxel; expected --component, or .nrrd, .vti or .nii");
  if (auto problem = refuse_steps(voxels, "FITS")) return problem;
  const qnv::VolumeLayout& layout = voxels.layout();
  constexpr std::size_t kBlock = 2880;
  std::string head =
      card("SIMPLE", "T") + card("BITPIX", std::to_string(names_of(layout.type).fits)) + card("NAXIS", "3");
  for (std::size_t i = 0; i < 3; ++i)
    head += card("NAXIS" + std::to_string(i + 1), std::to_string(layout.dimensions[i]));
  if (layout.slope != 1 || layout.intercept != 0)
    head += card("BSCALE", fits_number(layout.slope)) + card("BZERO", fits_number(layout.intercept));
  if (layout.missing && layout.type != VoxelType::f32 && layout.type != VoxelType::f64)
    head += card("BLANK", shortest(std::round(*layout.missing)));
  const glm::dvec3 origin = layout.base + layout.origin;
  for (int i = 0; i < 3; ++i) {
    const std::string n = std::to_string(i + 1);
    head += card("CRPIX" + n, "1.") + card("CRVAL" + n, fits_number(origin[i])) +
            card("CDELT" + n, fits_number(glm::length(layout.axes[static_cast<std::size_t>(i)])));
  }
  if (const std::string unit = metadata_value(layout, "sample units"); !unit.empty()) head += card("BUNIT", unit, true);
  if (!options.title.empty()) head += card("OBJECT", options.title, true);
  std::string end = "END";
  end.resize(80, ' ');
  head += end;
  head.resize((head.size() + kBlock - 1) / kBlock * kBlock, ' ');
  const auto beyond = static_cast<std::size_t>(voxels.bytes() % kBlock);
  return write_all(head, voxels, std::string(beyond > 0 ? kBlock - beyond : 0, '\0'), take);
}

Exported export_nrrd(const qnv::Geometry& geometry, const ExportOptions& options) {
  return collected(write_nrrd, geometry, options);
}

Exported export_vti(const qnv::Geometry& geometry, const ExportOptions& options) {
  return collected(write_vti, geometry, options);
}

Exported export_nifti(const qnv::Geometry& geometry, const ExportOptions& options) {
  return collected(write_nifti, geometry, options);
}

Exported export_nifti_gz(const qnv::Geometry& geometry, const ExportOptions& options) {
  return collected(write_nifti_gz, geometry, options);
}

Exported export_fits(const qnv::Geometry& geometry, const ExportOptions& options) {
  return collected(write_fits, geometry, options);
}

}  // namespace gs::app
