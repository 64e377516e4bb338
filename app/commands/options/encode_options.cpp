#include "app/commands/options/encode_options.h"

#include "app/commands/encode.h"
#include "app/commands/export.h"
#include "app/commands/options/option_values.h"
#include "app/commands/options/setters.h"
#include "qnv/codecs/lossless/exact_mesh.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace gs::app {
namespace {

Problem set_vectors(ConversionOptions& options, const std::string& value) {
  return read_count(value, options.vectors) && options.vectors > 0 ? Problem{} : "expected a number of vectors above 0";
}

Problem set_exact(ConversionOptions& options, const std::string& value) {
  constexpr int kUsualBits = 11;
  options.exact_bits = value == "none" ? 0 : kUsualBits;
  const bool good = value.empty() || value == "none" ||
                    (read(value, options.exact_bits) && options.exact_bits >= qnv::exact::kMinBits &&
                     options.exact_bits <= qnv::exact::kMaxBits);
  return good ? Problem{} : "expected a number of bits from 8 to 20, or none";
}

Problem set_fraction(ConversionOptions& options, const std::string& value) {
  return read(value, options.fraction) && options.fraction > 0 && options.fraction <= 1
             ? Problem{}
             : "expected a number from 0 to 1";
}

Problem set_isovalue(ConversionOptions& options, const std::string& value) {
  double isovalue = 0;
  if (!read(value, isovalue) || !std::isfinite(isovalue)) return "expected a number";
  options.isovalue = isovalue;
  return {};
}

Problem set_seed(ConversionOptions& options, const std::string& value) {
  return read(value, options.seed) ? Problem{} : "expected a whole number";
}

Problem set_dimensions(InputOptions& options, const std::string& value) {
  return read_dimensions(value, options.raw) ? Problem{} : "expected WIDTHxHEIGHTxDEPTH in voxels";
}

Problem set_voxel_type(InputOptions& options, const std::string& value) {
  return read_voxel_type(value, options.raw) ? Problem{} : "expected " + std::string(kVoxelTypes);
}

Problem set_spacing(InputOptions& options, const std::string& value) {
  double spacing[3];
  if (!read_list(value, ',', spacing) ||
      std::any_of(spacing, spacing + 3, [](double s) { return !(s > 0) || !std::isfinite(static_cast<float>(s)); }))
    return "expected X,Y,Z, each above 0";
  for (std::size_t i = 0; i < 3; ++i) options.raw.spacing[i] = static_cast<float>(spacing[i]);
  return {};
}

Problem set_offset(InputOptions& options, const std::string& value) {
  return read_bytes(value, options.raw.offset) ? Problem{} : std::string(kExpectedBytes);
}

Problem set_length(double& length, const std::string& value) {
  return read(value, length) && std::isfinite(length) && length >= 0 ? Problem{} : "expected a length of at least 0";
}

Problem set_tolerance(EncodeCommand& options, const std::string& value) {
  return set_length(options.tolerance.emplace(), value);
}

Problem set_groups(EncodeCommand& options, const std::string& value) {
  return read(value, options.groups) && options.groups > 0 ? Problem{} : "expected a number of groups above 0";
}

Problem set_position_bits(EncodeCommand& options, const std::string& value) {
  return read(value, options.position_bits) && options.position_bits >= 8 && options.position_bits <= 30
             ? Problem{}
             : "expected 8 to 30";
}

constexpr OptionRow kEncodeOptions[] = {
    {"--vectors", "N", "", "write about this number of vectors", "encode export ", with<set_vectors>},
    {"--fraction", "F", "", "keep this share of the voxels, vectors or triangles (0 to 1)", "encode ",
     with<set_fraction>},
    {"--isovalue", "V", "", "extract the surface of a volume at this value instead of its gradients", "encode export ",
     with<set_isovalue>},
    {"--displaced", "", "",
     "encode a base mesh with displacements along its normals (the default for suitable surfaces)", "encode ",
     flag<&ConversionOptions::displaced>},
    {"--exact", "[=BITS]", "11",
     "add the exact mesh after the refinements of a surface; export writes this mesh. Vertices have 2^BITS positions "
     "along the longest edge of the bounding box (8 to 20). The default adds it to surfaces of up to 300,000 "
     "triangles, with 11 to 14 bits and parity against losses. --exact=none omits it",
     "encode ", with<set_exact>},
    {"--packed", "", "",
     "encode an entropy-coded octree (the default for surfaces of many small parts). Points need a quarter of the "
     "bytes, with positions accurate to their spacing",
     "encode ", flag<&ConversionOptions::packed>},
    {"--records", "", "", "encode records of 8 bytes (the default for splats and points)", "encode ",
     flag<&ConversionOptions::records>},
    {"--outlines", "", "", "encode outline groups, outlines first; OUT may be .wrl, .wrz or .qnv", "encode ",
     flag<&EncodeCommand::outlines>},
    {"--tolerance", "LENGTH", "1/200 of the diagonal", "outlines: maximum distance of a group from its plane",
     "encode ", with<set_tolerance>},
    {"--groups", "N", "",
     "outlines: join groups until this number is left, at any distance unless --tolerance is given", "encode ",
     with<set_groups>},
    {"--merge", "LENGTH", "0",
     "outlines: merge polygons within this distance of a plane; 0 merges only coplanar polygons", "encode ",
     with<[](EncodeCommand& o, const std::string& v) { return set_length(o.merge, v); }>},
    {"--position-bits", "N", "16", "outlines in a stream: bits per coordinate along the longest side", "encode ",
     with<set_position_bits>},
    {"--seed", "S", "1", "set the order of records; the same seed gives the same stream", "encode ", with<set_seed>},
    {"--dims", "XxYxZ", "", "size in voxels of a volume without a header; x varies fastest", "encode export info ",
     with<set_dimensions>},
    {"--type", "TYPE", "u8",
     "type of its voxels: u8, i8, u16, i16, u32, i32, f32 or f64, with the suffix be for big-endian",
     "encode export info ", with<set_voxel_type>},
    {"--spacing", "X,Y,Z", "1,1,1", "distances of its voxels", "encode export info ", with<set_spacing>},
    {"--offset", "SIZE", "0", "bytes before the first voxel", "encode export info ", with<set_offset>},
    {"--vrml97", "", "", "write a world for any VRML97 browser; GhostSpace finds the stream in it", "export ",
     flag<&ExportCommand::vrml97>},
};

}  // namespace

std::span<const OptionRow> encode_option_rows() { return kEncodeOptions; }

}  // namespace gs::app
