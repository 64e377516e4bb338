#include "app/commands/options/encode_options.h"

#include "app/commands/options/option_values.h"
#include "qnv/exact/exact_mesh.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace gs::app {
namespace {

using EncodeProblem = std::optional<std::string>;

EncodeProblem set_vectors(Options& options, const std::string& value) {
  return read_count(value, options.vectors) && options.vectors > 0 ? EncodeProblem{}
                                                                   : "expected a number of vectors, more than 0";
}

EncodeProblem set_exact(Options& options, const std::string& value) {
  constexpr int kUsualBits = 11;
  options.exact_bits = value == "none" ? 0 : kUsualBits;
  const bool good = value.empty() || value == "none" || (read(value, options.exact_bits) && options.exact_bits >= qnv::exact::kLeastBits &&
                                      options.exact_bits <= qnv::exact::kMostBits);
  return good ? EncodeProblem{} : "expected a number of bits from 8 to 20, or none";
}

EncodeProblem set_fraction(Options& options, const std::string& value) {
  return read(value, options.fraction) && options.fraction > 0 && options.fraction <= 1
             ? EncodeProblem{}
             : "expected a number from 0 (without) to 1";
}

EncodeProblem set_isovalue(Options& options, const std::string& value) {
  double isovalue = 0;
  if (!read(value, isovalue) || !std::isfinite(isovalue)) return "expected a number";
  options.isovalue = isovalue;
  return {};
}

EncodeProblem set_seed(Options& options, const std::string& value) {
  return read(value, options.seed) ? EncodeProblem{} : "expected a whole number";
}

EncodeProblem set_dimensions(Options& options, const std::string& value) {
  return read_dimensions(value, options.raw) ? EncodeProblem{} : "expected WIDTHxHEIGHTxDEPTH in voxels";
}

EncodeProblem set_voxel_type(Options& options, const std::string& value) {
  return read_voxel_type(value, options.raw) ? EncodeProblem{} : "expected " + std::string(kVoxelTypes);
}

EncodeProblem set_spacing(Options& options, const std::string& value) {
  double spacing[3];
  if (!read_list(value, ',', spacing) ||
      std::any_of(spacing, spacing + 3, [](double s) { return !(s > 0) || !std::isfinite(static_cast<float>(s)); }))
    return "expected X,Y,Z, each more than 0";
  for (std::size_t i = 0; i < 3; ++i) options.raw.spacing[i] = static_cast<float>(spacing[i]);
  return {};
}

EncodeProblem set_offset(Options& options, const std::string& value) {
  return read_bytes(value, options.raw.offset) ? EncodeProblem{} : std::string(kExpectedBytes);
}

EncodeProblem set_length(double& length, const std::string& value) {
  return read(value, length) && std::isfinite(length) && length >= 0 ? EncodeProblem{}
                                                                     : "expected a length, at least 0";
}

EncodeProblem set_tolerance(Options& options, const std::string& value) {
  double length = 0;
  const EncodeProblem problem = set_length(length, value);
  options.tolerance = length;
  return problem;
}

EncodeProblem set_groups(Options& options, const std::string& value) {
  return read(value, options.groups) && options.groups > 0 ? EncodeProblem{}
                                                           : "expected a number of groups, more than 0";
}

EncodeProblem set_position_bits(Options& options, const std::string& value) {
  return read(value, options.position_bits) && options.position_bits >= 8 && options.position_bits <= 30
             ? EncodeProblem{}
             : "expected 8 to 30";
}

constexpr OptionRow kEncodeOptions[] = {
    {"--vectors", "N", "", "about so many vectors", "encode export ", set_vectors},
    {"--fraction", "F", "", "this part of a volume's voxels, of a cloud's vectors, of a surface's triangles (0 to 1)",
     "encode ", set_fraction},
    {"--isovalue", "V", "", "the surface of a volume where it has this value, in the place of its gradients",
     "encode export ", set_isovalue},
    {"--displaced", "", "",
     "base mesh and displacements along its normals: the best picture of a surface (the default where a base follows "
     "it)",
     "encode ",
     [](Options& o, const std::string&) {
       o.displaced = true;
       return EncodeProblem{};
     }},
    {"--exact", "[=BITS]", "11",
     "behind the refinements of a surface the mesh itself, its vertices on 2^BITS places along the longest edge of its "
     "box (8 to 20), in few bytes: who waits for the end gets the file, which export writes. Surfaces of up to 300,000 "
     "triangles have it without being asked, with 11 to 14 bits and what stands losses; --exact=none: "
     "without it",
     "encode ", set_exact},
    {"--packed", "", "",
     "entropy-coded octree, for surfaces of many small parts (the default for them), and for points, which then take a "
     "fourth of the bytes and are where they were but for their spacing",
     "encode ",
     [](Options& o, const std::string&) {
       o.packed = true;
       return EncodeProblem{};
     }},
    {"--records", "", "", "records of 8 bytes (the default for splats and points)", "encode ",
     [](Options& o, const std::string&) {
       o.records = true;
       return EncodeProblem{};
     }},
    {"--outlines", "", "",
     "outline groups: polygons that each stand alone, outlines first; OUT may be .wrl, .wrz or .qnv", "encode ",
     [](Options& o, const std::string&) {
       o.outlines = true;
       return EncodeProblem{};
     }},
    {"--tolerance", "LENGTH", "1/200 of the diagonal", "outlines: how far a group may lie from its plane", "encode ",
     set_tolerance},
    {"--groups", "N", "",
     "outlines: join groups until so many are left, however far from their planes unless --tolerance is given",
     "encode ", set_groups},
    {"--merge", "LENGTH", "0", "outlines: polygons this near to a plane become one; 0: only what is coplanar",
     "encode ", [](Options& o, const std::string& v) { return set_length(o.merge, v); }},
    {"--position-bits", "N", "16", "outlines in a stream: bits of a coordinate along the longest side", "encode ",
     set_position_bits},
    {"--seed", "S", "1", "of the order of records; one seed, one stream", "encode ", set_seed},
    {"--dims", "XxYxZ", "", "a volume without header: its voxels, x fastest", "encode export info ", set_dimensions},
    {"--type", "TYPE", "u8",
     "what its voxels are: u8, i8, u16, i16, u32, i32, f32 or f64, with be behind it if big-endian",
     "encode export info ", set_voxel_type},
    {"--spacing", "X,Y,Z", "1,1,1", "the distances of its voxels", "encode export info ", set_spacing},
    {"--offset", "SIZE", "0", "how many bytes come before the first voxel", "encode export info ", set_offset},
    {"--vrml97", "", "", "a world for any VRML97 browser, in which ours finds the stream", "export ",
     [](Options& o, const std::string&) {
       o.vrml97 = true;
       return EncodeProblem{};
     }},
};

}  // namespace

std::span<const OptionRow> encode_option_rows() { return kEncodeOptions; }

}  // namespace gs::app
