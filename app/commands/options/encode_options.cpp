#include "app/commands/options/encode_options.h"

#include "app/commands/encode.h"
#include "app/commands/export.h"
#include "app/commands/options/option_values.h"
#include "app/commands/options/setters.h"
#include "qnv/codecs/lossless/exact_mesh.h"
#include "qnv/codecs/shared/parity_writer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace gs::app {
namespace {

Problem set_vectors(ConversionOptions& options, const std::string& value) {
  return read_count(value, options.vectors) && options.vectors > 0 ? Problem{} : "expected a number of vectors above 0";
}

Problem set_method(ConversionOptions& options, EncodeMethod method) {
  options.methods_differ |= options.method != EncodeMethod::automatic && options.method != method;
  options.method = method;
  return {};
}

// Rows of `--method`. The last words are former spellings.
struct MethodName {
  std::string_view name;
  EncodeMethod method;
};
constexpr MethodName kMethods[] = {
    {"auto", EncodeMethod::automatic},      {"displaced", EncodeMethod::displaced}, {"octree", EncodeMethod::octree},
    {"records", EncodeMethod::records},     {"outlines", EncodeMethod::outlines},   {"values", EncodeMethod::values},
    {"gaussians", EncodeMethod::gaussians}, {"packed", EncodeMethod::octree},
};

Problem set_method_by_name(ConversionOptions& options, const std::string& value) {
  for (const MethodName& row : kMethods)
    if (row.name == value) return set_method(options, row.method);
  return "expected auto, displaced, octree, records, outlines, values or gaussians";
}

template <EncodeMethod method>
Problem former_method(ConversionOptions& options, const std::string&) {
  return set_method(options, method);
}

Problem set_keep_mesh(ConversionOptions& options, const std::string& value) {
  options.exact_bits = value == "none" ? 0 : qnv::exact::kMaxBits;
  const bool good = value == "none" || value == "exact" ||
                    (read(value, options.exact_bits) && options.exact_bits >= qnv::exact::kMinBits &&
                     options.exact_bits <= qnv::exact::kMaxBits);
  return good ? Problem{} : "expected none, exact or a number of bits from 8 to 20";
}

// Sets the value of `--exact`, the former spelling of `--keep-mesh`.
Problem set_exact(ConversionOptions& options, const std::string& value) {
  constexpr int kUsualBits = 11;
  options.exact_bits = value == "none" ? 0 : kUsualBits;
  const bool good = value.empty() || value == "none" ||
                    (read(value, options.exact_bits) && options.exact_bits >= qnv::exact::kMinBits &&
                     options.exact_bits <= qnv::exact::kMaxBits);
  return good ? Problem{} : "expected a number of bits from 8 to 20, or none";
}

Problem set_fraction(ConversionOptions& options, const std::string& value) {
  return read_share(value, options.fraction) && options.fraction > 0
             ? Problem{}
             : "expected a share from 0 to 1, or a percentage such as 30%";
}

Problem set_error(ConversionOptions& options, const std::string& value) {
  qnv::ValueTolerance& tolerance = options.value_tolerance;
  double error = 0;
  tolerance.of_range = value.ends_with('%');
  const std::string number = tolerance.of_range ? value.substr(0, value.size() - 1) : value;
  if (!read(number, error) || !std::isfinite(error) || error < 0 || (tolerance.of_range && error > 100))
    return "expected a number of at least 0 in the unit of the values, or a percentage of their range such as 0.1%";
  tolerance.error = tolerance.of_range ? error / 100 : error;
  return {};
}

Problem set_lossless(ConversionOptions& options, const std::string&) {
  options.value_tolerance.lossless = true;
  return {};
}

Problem set_parity(ConversionOptions& options, const std::string& value) {
  double share = 0;
  if (!read_share(value, share) || share > qnv::kMostLoss) return "expected a share from 0 to 0.5, or up to 50%";
  options.parity = share;
  return {};
}

Problem set_isovalue(ConversionOptions& options, const std::string& value) {
  double isovalue = 0;
  if (!read(value, isovalue) || !std::isfinite(isovalue)) return "expected a number";
  options.isovalue = isovalue;
  return {};
}

Problem set_share_of_picture(PictureOptions& options, const std::string& value) {
  const auto share = read_share(value);
  if (share) options.volume.display.share = *share;
  return share ? Problem{} : "expected a share of the voxels from 0.005 to 0.5, or from 0.5% to 50%";
}

Problem set_isovalue_of_picture(PictureOptions& options, const std::string& value) {
  double isovalue = 0;
  if (!read(value, isovalue) || !std::isfinite(static_cast<float>(isovalue))) return "expected a number";
  options.volume.display.surface = true;
  options.volume.display.isovalue = static_cast<float>(isovalue);
  return {};
}

/// Sets the fraction for encode, or the share of the voxels for pictures.
Problem set_any_fraction(CommandOptions& options, const std::string& value) {
  auto* const picture = dynamic_cast<PictureOptions*>(&options);
  return picture ? set_share_of_picture(*picture, value) : with<set_fraction>(options, value);
}

Problem set_any_isovalue(CommandOptions& options, const std::string& value) {
  auto* const picture = dynamic_cast<PictureOptions*>(&options);
  return picture ? set_isovalue_of_picture(*picture, value) : with<set_isovalue>(options, value);
}

Problem set_most_voxels(ConversionOptions& options, const std::string& value) {
  return read_bytes(value, options.most_voxels) && options.most_voxels > 0
             ? Problem{}
             : "expected a number of voxels above 0, such as 500000 or 1M";
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
    {"--fraction", "SHARE", "",
     "encode: keep this share of the voxels, vectors or triangles (0 to 1, or 30%). Pictures: draw this share of the "
     "voxels of a volume as vectors (0.005 to 0.5, usually 0.09)",
     "open animate encode ", set_any_fraction},
    {"--most-voxels", "N", "",
     "volumes: keep every n-th voxel along each axis, so that at most this number is left, optionally with K or M: 1M",
     "encode ", with<set_most_voxels>},
    {"--isovalue", "V", "",
     "extract the surface of a volume, or of a stream of its values, at this value instead of its gradients",
     "open animate encode export ", set_any_isovalue},
    {"--error", "SIZE", "1/8192 of the range",
     "maximum error of each voxel of a volume: in the unit of the values (12), or as a percentage of their range "
     "(0.1%). Of Gaussian splats: of the positions of large splats, as a percentage of their deviations (usually 5%); "
     "shapes and colours follow",
     "encode ", with<set_error>},
    {"--resume", "", "", "of ghostspace-mpi: continue a run that ended early, with the same input and options",
     "encode ", flag<&EncodeCommand::resume>},
    {"--lossless", "", "", "values of a volume: restore the stored voxels bit for bit; float64 is stored as float32",
     "encode ", with<set_lossless>},
    {"--parity", "SHARE", "",
     "add parity that restores this share of lost chunks (0 to 0.5, or 30%); 0 adds none. 10% takes a third more "
     "bytes, 30% twice the bytes. The default protects the coarse part of a volume with 3% of the bytes",
     "encode ", with<set_parity>},
    {"--method", "auto|displaced|octree|records|outlines|values|gaussians", "auto",
     "encode a base mesh with displacements (displaced, usual for smooth surfaces), an octree of splats (octree, usual "
     "for surfaces of many small parts, and for points in a quarter of the bytes), records of 8 bytes (records, usual "
     "for points), outline groups with their outlines first (outlines; OUT may be .wrl, .wrz or .qnv), or "
     "the values of a volume (values, usual for volumes unless --vectors or --fraction selects gradients), or Gaussian "
     "splats with opacities and harmonics (gaussians, usual for files of splats)",
     "encode ", with<set_method_by_name>},
    {"--keep-mesh", "none|exact|BITS", "for up to 300,000 triangles",
     "end the stream of a surface with its original mesh, which export writes. Vertices have 2^BITS positions along "
     "the longest edge of the bounding box (8 to 20; exact is 20). The default adds 11 to 14 bits and parity against "
     "losses",
     "encode ", with<set_keep_mesh>},
    {"--displaced", "", "", "--method displaced", "encode ", with<former_method<EncodeMethod::displaced>>, false, true},
    {"--packed", "", "", "--method octree", "encode ", with<former_method<EncodeMethod::octree>>, false, true},
    {"--records", "", "", "--method records", "encode ", with<former_method<EncodeMethod::records>>, false, true},
    {"--outlines", "", "", "--method outlines", "encode ", with<former_method<EncodeMethod::outlines>>, false, true},
    {"--exact", "[=BITS]", "11", "--keep-mesh, with 11 bits", "encode ", with<set_exact>, false, true},
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
