#include "base/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

namespace gs {
namespace {

constexpr std::size_t kUnpackedBytes = std::size_t{256} << 10;
constexpr int kGzipWindow = 15 + 16;  // zlib: largest window, gzip framing

}  // namespace

bool is_gzip(std::span<const std::byte> bytes) {
  return bytes.size() >= 2 && bytes[0] == std::byte{0x1f} && bytes[1] == std::byte{0x8b};
}

struct Gunzip::State {
  z_stream stream{};
  std::vector<char> piece = std::vector<char>(kUnpackedBytes);
  WorldBudget budget;
  std::uint64_t taken = 0, total = 0;  // numbers of compressed and decompressed bytes so far
  std::size_t mark = 0;  // received bytes of the next member's mark: 0, 1 or 2
  bool between = false;  // a member has ended, and the next one has not begun
  bool over = false;                   // further input is ignored
  bool stopped = false;                // the sink returned false
  std::optional<std::string> problem;

  void fail(std::string message) {
    problem = std::move(message);
    over = true;
  }

  // Looks for another member (RFC 1952 2.2). Ignores all further input if other bytes follow the last member.
  void look_for_member(std::span<const std::byte>& bytes) {
    static constexpr Bytef kMark[] = {0x1f, 0x8b};
    while (mark < 2 && !bytes.empty()) {
      if (bytes.front() != static_cast<std::byte>(kMark[mark])) {
        over = true;
        return;
      }
      bytes = bytes.subspan(1);
      ++mark;
    }
    if (mark < 2) return;
    between = false;
    mark = 0;
    if (inflateReset(&stream) != Z_OK) return fail("zlib cannot be initialised");
    stream.next_in = const_cast<Bytef*>(kMark);
    stream.avail_in = 2;
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    if (inflate(&stream, Z_NO_FLUSH) != Z_OK) fail("the gzip data is damaged");
  }

  void inflate_some(std::span<const std::byte>& bytes, const Sink& sink) {
    const std::size_t given = std::min<std::size_t>(bytes.size(), std::numeric_limits<uInt>::max());
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(given);
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    const int status = inflate(&stream, Z_NO_FLUSH);
    bytes = bytes.subspan(given - stream.avail_in);
    std::size_t made = piece.size() - stream.avail_out;
    taken += given - stream.avail_in;
    total += made;
    const Limits& limits = budget->limits();
    if (total > limits.unpack_free && total / limits.unpack_ratio > taken)
      return fail("unpacks to more than " + std::to_string(limits.unpack_ratio) + " times its size");
    bool room = budget->take(Resource::unpacked, made);
    if (!room) {
      // Limits the output exactly to the budget, whatever the sizes of the input pieces.
      made = std::min<std::size_t>(made, budget->left(Resource::unpacked));
      (void)budget->take(Resource::unpacked, made);
    }
    // Passes the output on even if the time limit has passed.
    if (made > 0 && !sink(std::string_view(piece.data(), made))) {
      over = stopped = true;
      return;
    }
    if (budget->stopped()) return fail("the time limit was reached during unpacking");
    if (!room) return fail("unpacks to " + budget->refusal(Resource::unpacked));
    if (status == Z_STREAM_END)
      between = true;
    else if (status != Z_OK && status != Z_BUF_ERROR)
      fail(std::string("the gzip data is damaged") + (stream.msg ? std::string(" (") + stream.msg + ")" : ""));
    else if (status == Z_BUF_ERROR && !bytes.empty())
      fail("the gzip data is damaged");  // unreachable: there is input and output space
  }
};

Gunzip::Gunzip(WorldBudget budget) : state_(std::make_unique<State>()) {
  state_->budget = std::move(budget);
  if (inflateInit2(&state_->stream, kGzipWindow) != Z_OK) state_->fail("zlib cannot be initialised");
}

Gunzip::~Gunzip() { inflateEnd(&state_->stream); }

bool Gunzip::push(std::span<const std::byte> bytes, const Sink& sink) {
  State& s = *state_;
  while (!s.over && !bytes.empty()) {
    if (s.between)
      s.look_for_member(bytes);
    else
      s.inflate_some(bytes, sink);
  }
  // If the output exactly fills a piece, zlib may have more output ready.
  while (!s.over && !s.between && s.stream.avail_out == 0) s.inflate_some(bytes, sink);
  return !s.over;
}

std::optional<std::string> Gunzip::finish() {
  if (!state_->problem && !state_->between && !state_->over) state_->problem = "the gzip data is truncated";
  return state_->stopped ? std::nullopt : state_->problem;
}

std::vector<std::byte> gzip(std::span<const std::byte> bytes) {
  constexpr int kLevel = 9, kMemory = 8;
  z_stream stream{};
  if (deflateInit2(&stream, kLevel, Z_DEFLATED, kGzipWindow, kMemory, Z_DEFAULT_STRATEGY) != Z_OK) return {};
  std::vector<std::byte> out;
  std::vector<std::byte> piece(std::size_t{1} << 18);
  int status = Z_OK;
  do {
    // zlib counts in 32 bits.
    const std::size_t some = std::min<std::size_t>(bytes.size(), std::size_t{1} << 30);
    if (stream.avail_in == 0) {
      stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));
      stream.avail_in = static_cast<uInt>(some);
      bytes = bytes.subspan(some);
    }
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    status = deflate(&stream, bytes.empty() ? Z_FINISH : Z_NO_FLUSH);
    out.insert(out.end(), piece.begin(), piece.end() - static_cast<std::ptrdiff_t>(stream.avail_out));
  } while (status == Z_OK || status == Z_BUF_ERROR);
  deflateEnd(&stream);
  return out;
}

std::optional<std::string> gunzip(std::span<const std::byte> bytes, const WorldBudget& budget,
                                  const Gunzip::Sink& sink) {
  Gunzip unpacking(budget);
  unpacking.push(bytes, sink);
  return unpacking.finish();
}

UnpackedBytes unpack_gzip(std::span<const std::byte> bytes, const WorldBudget& budget, Resource resource) {
  UnpackedBytes result;
  result.share = Share(budget, resource);
  std::size_t refused = 0;
  result.problem = gunzip(bytes, budget, [&](std::string_view piece) {
    if (!result.share.grow(piece.size())) {
      refused = piece.size();
      return false;
    }
    std::memcpy(result.bytes.prepare(piece.size()), piece.data(), piece.size());
    result.bytes.commit(piece.size());
    return true;
  });
  if (refused > 0) result.problem = "unpacks to " + budget->refusal(resource);
  result.bytes.shrink_to_fit();
  return result;
}

}  // namespace gs
