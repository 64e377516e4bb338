#include "app/loading/resources/outline_reader.h"
#include "qnv/codecs/octree/lod/lod_source.h"

#include <utility>
#include <variant>

// Decoding of outline streams into polygons of OutlineGroup nodes.
namespace gs::app {

void OutlineReader::receive(std::span<const std::byte> bytes) {
  (void)decoder_.push(bytes);
  show();
}

// Decodes one complete chunk, received as cells.
void OutlineReader::receive_piece(const net::CellEvent& event) {
  const auto chunk = qnv::sound_chunk(event.bytes);
  if (const auto* sound = std::get_if<qnv::SoundChunk>(&chunk)) decoder_.add(sound->type, sound->payload);
  show();
}

void OutlineReader::show() {
  if (!decoder_.header()) return;
  const std::vector<qnv::OutlineBatch> batches = decoder_.take();
  if (batches.empty()) return;
  outlines_.add(decoder_.header()->outlines, batches);
  changed_ = true;
}

void OutlineReader::end(const std::string& file, bool whole) {
  if (whole) decoder_.finish();
  show();
  if (whole) outlines_.complete();
  changed_ = true;
  for (const qnv::StreamProblem& problem : decoder_.problems())
    loading_.results.report(decoder_.refused() ? Severity::error : Severity::warning, file, {},
                            "byte " + std::to_string(problem.offset) + ": " + problem.message);
  if (outlines_.full())
    loading_.results.report(Severity::error, file, {},
                            loading_.budget->refusal(Resource::nodes) + "; skipped the rest of the polygons");
  const std::size_t refused = decoder_.refused_records();
  if (refused > 0)
    loading_.results.report(Severity::warning, file, {}, std::to_string(refused) + " damaged polygons are left out");
}

std::vector<vrml::NodeId> OutlineReader::take_changed() {
  return std::exchange(changed_, false) ? outlines_.nodes() : std::vector<vrml::NodeId>();
}

}  // namespace gs::app
