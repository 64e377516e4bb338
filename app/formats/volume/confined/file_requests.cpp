#include "app/formats/volume/confined/file_requests.h"

#include "app/base/local_file.h"
#include "app/confined/decoder_channel.h"
#include "app/formats/common/transfer.h"
#include "net/base/range_set.h"
#include "net/files/file.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

#include <fcntl.h>

namespace gs::app {
namespace {

// Texts: "|m|OFFSET|BYTES|REFERENCE" for a file of a batch, "|e|..." for its last file, "|l|REFERENCE" for a folder.
// For the last bytes of a file, OFFSET is the letter e. For a whole file, OFFSET and BYTES are empty. For parts of the
// child's own file, all references of the batch are empty. No reference begins with '|', because URLs percent-encode it
// (RFC 3986, 2).
constexpr char kRequestMark = '|', kMoreFollow = 'm', kLastOfBatch = 'e', kListFolder = 'l';
constexpr std::string_view kBytesFromEnd = "e";
constexpr std::size_t kMostFilesOfBatch = 4096;

enum class AnswerTag : std::uint8_t { bytes, none, problem };

std::string request_text(const FileRequest& request, bool last) {
  std::string text{kRequestMark, last ? kLastOfBatch : kMoreFollow, kRequestMark};
  if (request.part) text += request.part->from_end ? std::string(kBytesFromEnd) : std::to_string(request.part->offset);
  text += kRequestMark;
  if (request.part) text += std::to_string(request.part->bytes);
  return text + kRequestMark + request.reference;
}

/// Takes the text before the next mark.
std::optional<std::string_view> take_field(std::string_view& text) {
  const std::size_t end = text.find(kRequestMark);
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view field = text.substr(0, end);
  text.remove_prefix(end + 1);
  return field;
}

std::optional<std::uint64_t> whole_number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [at, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && at == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// Reads the text behind "|m|" or "|e|".
std::optional<FileRequest> file_request_of(std::string_view text) {
  const auto offset = take_field(text);
  const auto bytes = offset ? take_field(text) : std::nullopt;
  if (!bytes) return std::nullopt;
  FileRequest request{std::string(text)};
  if (offset->empty() && bytes->empty()) return text.empty() ? std::nullopt : std::optional(std::move(request));
  const bool from_end = *offset == kBytesFromEnd;
  if (from_end && text.empty()) return std::nullopt;
  const auto first = from_end ? std::optional<std::uint64_t>(0) : whole_number(*offset);
  const auto count = whole_number(*bytes);
  if (!first || !count || *first + *count < *first) return std::nullopt;
  request.part = FilePart{*first, *count, from_end};
  return request;
}

/// Copies bytes into a file without a name, so that they travel as a descriptor: the memory for results is in use.
BytesResult as_descriptor(std::span<const std::byte> bytes) {
  auto memory = SharedMemory::create();
  const bool grown = memory && !bytes.empty() && memory->grow(bytes.size());
  const auto to = grown ? memory->map(bytes.size()) : std::span<std::byte>();
  if (to.size() != bytes.size() || bytes.empty()) return std::string("no memory for files");
  std::memcpy(to.data(), bytes.data(), bytes.size());
  auto mapped = net::map_descriptor(net::Descriptor(::fcntl(memory->file(), F_DUPFD_CLOEXEC, 0)));
  if (!mapped) return std::string("no memory for files");
  return shared_bytes(std::move(*mapped));
}

}  // namespace

bool is_file_request(const std::string& text) { return text.starts_with(kRequestMark); }

ReadFiles files_by_asking(const ReadFile& ask) {
  return [ask](std::span<const FileRequest> requests) {
    std::vector<FileResult> results;
    BytesResult answer = std::string("it was not read");
    for (std::size_t i = 0; i < requests.size(); ++i) answer = ask(request_text(requests[i], i + 1 == requests.size()));
    const auto* const all = std::get_if<SharedBytes>(&answer);
    if (!all) return std::vector<FileResult>(requests.size(), std::get<std::string>(answer));
    try {
      TransferReader from(all->bytes);
      while (results.size() < requests.size()) {
        const auto tag = from.value<AnswerTag>();
        if (tag == AnswerTag::none)
          results.emplace_back(NoFile());
        else if (tag == AnswerTag::problem)
          results.emplace_back(from.text());
        else
          results.push_back(SharedBytes{all->owner, from.bytes()});
      }
    } catch (const Impossible&) {
      results.resize(requests.size(), std::string("it was not read"));
    }
    return results;
  };
}

ListFolder folders_by_asking(const ReadFile& ask) {
  return [ask](const std::string& reference) -> std::optional<std::vector<std::string>> {
    const BytesResult answer = ask(std::string{kRequestMark, kListFolder, kRequestMark} + reference);
    const auto* const all = std::get_if<SharedBytes>(&answer);
    if (!all) return std::nullopt;
    std::vector<std::string> names;
    try {
      TransferReader from(all->bytes);
      for (auto left = from.value<std::uint64_t>(); left > 0; --left) names.push_back(from.text());
    } catch (const Impossible&) {
      return std::nullopt;
    }
    return names;
  };
}

NeedBytes parts_by_asking(const ReadFile& ask) {
  return [ask, known = std::make_shared<net::RangeSet>()](std::span<const ByteSpan> parts) {
    std::vector<FileRequest> missing;
    for (const ByteSpan& part : parts)
      if (part.bytes > 0 && !known->contains({part.offset, part.offset + part.bytes}))
        missing.push_back({{}, FilePart{part.offset, part.bytes}});
    for (std::size_t begin = 0; begin < missing.size(); begin += kMostFilesOfBatch) {
      const std::size_t end = std::min(begin + kMostFilesOfBatch, missing.size());
      BytesResult answer = std::string("it was not read");
      for (std::size_t i = begin; i < end; ++i) answer = ask(request_text(missing[i], i + 1 == end));
      if (!std::holds_alternative<SharedBytes>(answer)) return false;
      for (std::size_t i = begin; i < end; ++i)
        known->add({missing[i].part->offset, missing[i].part->offset + missing[i].part->bytes});
    }
    return true;
  };
}

BytesResult FileBatches::answer_parts(const std::vector<FileRequest>& batch) const {
  std::vector<ByteSpan> parts;
  for (const FileRequest& one : batch) parts.push_back({one.part->offset, one.part->bytes});
  return need_ && need_(parts) ? BytesResult(SharedBytes{}) : BytesResult(std::string("it cannot be read"));
}

std::optional<BytesResult> FileBatches::answer(const std::string& text) {
  std::string_view rest = text;
  if (rest.size() < 3 || rest[0] != kRequestMark || rest[2] != kRequestMark) return std::nullopt;
  const char kind = rest[1];
  rest.remove_prefix(3);
  if (kind == kListFolder) {
    const auto names = list_ ? list_(std::string(rest)) : std::nullopt;
    if (!names) return BytesResult(std::string("the folder cannot be listed"));
    TransferWriter to;
    to.value<std::uint64_t>(names->size());
    for (const std::string& name : *names) to.text(name);
    return as_descriptor(to.take());
  }
  auto request = file_request_of(rest);
  if ((kind != kMoreFollow && kind != kLastOfBatch) || !request || batch_.size() >= kMostFilesOfBatch ||
      (!batch_.empty() && batch_.front().reference.empty() != request->reference.empty()))
    return std::nullopt;
  batch_.push_back(std::move(*request));
  if (kind == kMoreFollow) return BytesResult(SharedBytes{});
  const std::vector<FileRequest> batch = std::exchange(batch_, {});
  if (batch.front().reference.empty()) return answer_parts(batch);
  std::vector<FileResult> results;
  if (read_) results = read_(batch);
  results.resize(batch.size(), std::string("other files are not read here"));
  TransferWriter to;
  for (const FileResult& result : results) {
    if (const auto* const bytes = std::get_if<SharedBytes>(&result)) {
      to.value(AnswerTag::bytes);
      to.list(bytes->bytes);
    } else if (const auto* const problem = std::get_if<std::string>(&result)) {
      to.value(AnswerTag::problem);
      to.text(*problem);
    } else {
      to.value(AnswerTag::none);
    }
  }
  return as_descriptor(to.take());
}

}  // namespace gs::app
