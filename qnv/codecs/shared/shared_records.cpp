#include "qnv/codecs/shared/shared_records.h"

#include "qnv/container/container.h"

#include <cstring>
#include <string>

namespace gs::qnv {
namespace {

EncodeError cannot_pass(const SpillStore& store) { return {"cannot pass data between processes: " + store.problem()}; }

/// Appends bytes to the store of this rank, from which other ranks can read them.
std::optional<EncodeError> offer(SpillStore& store, std::span<const std::byte> bytes) {
  constexpr std::size_t kPiece = std::size_t{8} << 20;
  for (std::size_t at = 0; at < bytes.size(); at += kPiece)
    if (!store.append(bytes.subspan(at, std::min(kPiece, bytes.size() - at)))) return cannot_pass(store);
  if (!store.publish()) return cannot_pass(store);
  return std::nullopt;
}

/// Range of bytes in the common store.
struct StoredPart {
  std::uint64_t at = 0, bytes = 0;
};

std::optional<EncodeError> fetch(const SpillStore& store, std::span<const StoredPart> parts, const RoomFor& room) {
  std::uint64_t all = 0;
  for (const StoredPart& part : parts) all += part.bytes;
  std::span<std::byte> to = room(all);
  for (const StoredPart& part : parts) {
    const auto bytes = static_cast<std::size_t>(part.bytes);
    if (bytes > 0 && !store.read(part.at, to.first(bytes))) return cannot_pass(store);
    to = to.subspan(bytes);
  }
  return std::nullopt;
}

}  // namespace

std::optional<EncodeError> read_share(EncodeRanks& shared, const TriangleSource& source, const TriangleSink& sink,
                                      Progress* progress) {
  const RankShare share = share_of(shared.ranks(), source.runs());
  std::optional<EncodeError> problem;
  bool wanted = true;
  for (std::uint64_t run = share.first; run < share.end && wanted && !problem; ++run) {
    const bool read = source.read(run, [&](std::span<const Triangle> triangles) {
      wanted = sink(triangles);
      return wanted && !is_cancelled(progress);
    });
    if (is_cancelled(progress))
      problem = EncodeError{"cancelled"};
    else if (!read && wanted)
      problem = EncodeError{kUnreadable};
  }
  return shared.agree(problem);
}

std::variant<SurfaceSurvey, EncodeError> survey_of(EncodeRanks& shared, const TriangleSource& source,
                                                   Progress* progress) {
  static_assert(std::is_trivially_copyable_v<SurfaceSurvey>);
  const std::string work = "survey " + std::to_string(source.runs());
  SurfaceSurvey all;
  const auto earlier = earlier_result(shared, work);
  if (earlier && earlier->size() == sizeof all) {
    std::memcpy(static_cast<void*>(&all), earlier->data(), sizeof all);
    return all;
  }
  const RankShare share = share_of(shared.ranks(), source.runs());
  std::vector<SurfaceSurvey> runs;
  std::optional<EncodeError> problem;
  if (progress && source.runs() > 1) {
    progress->done = 0;
    progress->total = share.size();
  }
  for (std::uint64_t run = share.first; run < share.end && !problem; ++run) {
    SurfaceSurvey& survey = runs.emplace_back();
    const bool read = source.read(run, [&](std::span<const Triangle> triangles) {
      survey.add(triangles);
      return !is_cancelled(progress);
    });
    if (!read) problem = EncodeError{is_cancelled(progress) ? "cancelled" : kUnreadable};
    if (progress && source.runs() > 1) ++progress->done;
  }
  if (auto failed = shared.agree(problem)) return std::move(*failed);
  for (const SurfaceSurvey& one : gather_records(shared.ranks(), std::span<const SurfaceSurvey>(runs))) all.add(one);
  if (auto failed = record_result(shared, work, std::as_bytes(std::span(&all, 1)))) return std::move(*failed);
  return all;
}

std::variant<EncodedStream, EncodeError> result_of_first(EncodeRanks& shared,
                                                         std::variant<EncodedStream, EncodeError> own) {
  if (shared.count() == 1) return own;
  // First byte: 0 means a stream, 1 an error, 2 a source that another payload can encode (EncodeError::unsuited).
  std::string text;
  if (shared.rank() == 0) {
    const auto* const failed = std::get_if<EncodeError>(&own);
    text = std::string(1, static_cast<char>(!failed ? 0 : failed->unsuited ? 2 : 1));
    if (failed) text += failed->message;
  }
  const std::vector<std::byte> told = shared.ranks().gather(std::as_bytes(std::span(text)));
  if (shared.rank() == 0) return own;
  if (told.empty() || told[0] == std::byte{0}) return EncodedStream{};
  EncodeError error;
  for (const std::byte one : std::span(told).subspan(1)) error.message.push_back(std::to_integer<char>(one));
  error.unsuited = told[0] == std::byte{2};
  return error;
}

std::optional<std::vector<std::byte>> earlier_result(EncodeRanks& shared, std::string_view work) {
  auto own = shared.store().finished(work);
  const std::byte found{own ? std::uint8_t{1} : std::uint8_t{0}};
  const std::vector<std::byte> all = shared.ranks().gather(std::span(&found, 1));
  const bool everywhere = std::ranges::all_of(all, [](std::byte one) { return one != std::byte{0}; });
  return everywhere ? std::move(own) : std::nullopt;
}

std::optional<EncodeError> record_result(EncodeRanks& shared, std::string_view work,
                                         std::span<const std::byte> result) {
  constexpr std::size_t kMost = std::size_t{512} << 20;
  if (result.size() > kMost) return std::nullopt;
  SpillStore& store = shared.store();
  std::optional<EncodeError> problem;
  if (shared.rank() == 0 && !store.finish(work, store.size(), result)) problem = cannot_pass(store);
  return shared.agree(problem);
}

std::optional<EncodeError> pass_parts(EncodeRanks& shared, std::span<const std::byte> own,
                                      std::span<const std::uint64_t> ends, const RoomFor& room) {
  SpillStore& store = shared.store();
  std::vector<StoredPart> parts;
  std::uint64_t begin = 0;
  for (const std::uint64_t end : ends) {
    parts.push_back({store.size() + begin, end - begin});
    begin = end;
  }
  if (auto failed = shared.agree(offer(store, own))) return failed;
  // Row r has the parts of rank r.
  const std::vector<StoredPart> table = gather_records(shared.ranks(), std::span<const StoredPart>(parts));
  std::vector<StoredPart> here;
  for (std::size_t from = 0; from < shared.count(); ++from) here.push_back(table[from * ends.size() + shared.rank()]);
  return shared.agree(fetch(store, here, room));
}

std::optional<EncodeError> collect_bytes(EncodeRanks& shared, std::span<const std::byte> own, bool all,
                                         const RoomFor& room) {
  SpillStore& store = shared.store();
  const StoredPart part{store.size(), own.size()};
  if (auto failed = shared.agree(offer(store, own))) return failed;
  const std::vector<StoredPart> parts = gather_records(shared.ranks(), std::span(&part, 1));
  if (!all && shared.rank() != 0) return shared.agree(std::nullopt);
  return shared.agree(fetch(store, parts, room));
}

}  // namespace gs::qnv
