#include "qnv/codecs/gaussians/lod/chunk_repair.h"

#include "qnv/container/lost_chunks.h"

#include <algorithm>
#include <exception>
#include <span>
#include <system_error>

namespace gs::qnv::gaussians {
namespace {

constexpr std::size_t kBytesPerRead = std::size_t{1} << 18;

}  // namespace

std::vector<StreamProblem> read_whole(const ChunkSource& source, bool parity, const StreamReader::OnChunk& take,
                                      const std::atomic<bool>* stop) {
  LostChunks lost;
  const LostChunks::Take restored = [&](ChunkType type, std::span<const std::byte> payload) {
    take(type, payload, kNowhere);
  };
  const StreamReader::OnChunk take_sound = [&](ChunkType type, std::span<const std::byte> payload,
                                               std::uint64_t offset) {
    take(type, payload, offset);
    if (!parity) return;
    if (type == ChunkType::parity)
      (void)lost.add(payload, restored);
    else if (type == ChunkType::gaussians || is_harmonics(type))
      lost.keep(type, payload, restored);
  };
  StreamReader reader;
  std::vector<std::byte> piece(static_cast<std::size_t>(std::min<std::uint64_t>(kBytesPerRead, source.size())));
  for (std::uint64_t at = 0; !stop || !*stop;) {
    const std::size_t count = source.read(at, piece);
    if (count == 0 || !reader.push(std::span(piece).first(count), take_sound)) break;
    at += count;
  }
  reader.finish(take_sound);
  return reader.problems();
}

ChunkRepair::ChunkRepair(std::shared_ptr<const ChunkSource> source, std::shared_ptr<ArrivedChunks> patches)
    : source_(std::move(source)), patches_(std::move(patches)) {
  try {
    thread_ = std::thread([this] { run(); });
  } catch (const std::system_error&) {
    run();  // the system has no more threads
  }
}

ChunkRepair::~ChunkRepair() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

void ChunkRepair::run() {
  try {
    const StreamReader::OnChunk take = [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
      if (offset < kNowhere) return;
      const std::uint64_t place = kNowhere + result_.chunks.size();
      if (patches_->add(place, encode_chunk(type, payload)))
        result_.chunks.push_back({type, place, kChunkHeaderBytes + payload.size()});
    };
    result_.problems = read_whole(*source_, true, take, &stop_);
  } catch (const std::exception&) {
    failed_ = true;  // adding a problem needs memory, too
  }
  ended_ = true;
}

ChunkRepair::Result ChunkRepair::finish() {
  if (thread_.joinable()) thread_.join();
  if (failed_) result_.problems.push_back({0, "damaged chunks are not restored: memory is insufficient"});
  return std::move(result_);
}

}  // namespace gs::qnv::gaussians
