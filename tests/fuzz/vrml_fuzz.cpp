// libFuzzer target, and with tests/fuzz/replay.cpp a plain program over a corpus: any bytes, whole and in
// pieces, must parse without harm and to the same scene, print, and tessellate.
#include "vrml/mesh.h"
#include "vrml/parser.h"
#include "vrml/printer.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

using namespace gs::vrml;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  Limits limits;
  limits.nodes = 20000;
  limits.expanded_nodes = 20000;
  limits.image_pixels = 1 << 16;
  SceneGraph whole("fuzz", limits), pieces("fuzz", limits);
  Diagnostics said_whole, said_pieces;
  const ParseOutcome outcome = parse(text, whole, said_whole);

  // The size of the pieces comes from the input, so that the fuzzer can choose it.
  const std::size_t piece = size > 0 ? 1 + data[size - 1] % 64 : 1;
  Parser parser(pieces, said_pieces);
  for (std::size_t i = 0; i < size; i += piece) parser.push(text.substr(i, piece));
  const ParseOutcome piecewise = parser.finish();

  const std::string printed = print(whole);
  if (piecewise != outcome || print(pieces) != printed || said_whole.entries().size() != said_pieces.entries().size())
    std::abort();
  MeshOptions coarse;
  coarse.segments = 6;
  for (std::uint32_t i = 1; i <= whole.node_count(); ++i) {
    const Mesh mesh = tessellate(whole, whole.id_at(i), coarse);
    for (const std::uint32_t index : mesh.indices)
      if (index >= mesh.positions.size()) std::abort();
  }
  return 0;
}
