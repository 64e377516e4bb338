#include "net/tunnel/tunnel_frames.h"

#include "net/base/network_bytes.h"

#include <algorithm>
#include <charconv>
#include <utility>

namespace gs::net {
namespace {

constexpr std::size_t kMaxHelloWords = 64;

std::uint32_t number_at(std::span<const std::byte> bytes) { return NetworkReader(bytes).integer<std::uint32_t>(); }

std::string_view next_word(std::string_view& text, char separator) {
  const std::size_t end = std::min(text.find(separator), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return word;
}

}  // namespace

void append_frame(std::vector<std::byte>& out, TunnelFrameKind kind, std::uint32_t connection,
                  std::span<const std::byte> payload) {
  NetworkWriter writer(out);
  writer.integer(static_cast<std::uint32_t>(payload.size()));
  writer.integer(static_cast<std::uint8_t>(kind));
  writer.integer(connection);
  writer.bytes(payload);
}

void append_frame(std::vector<std::byte>& out, TunnelFrameKind kind, std::uint32_t connection, std::string_view text) {
  append_frame(out, kind, connection, std::as_bytes(std::span(text.substr(0, kMaxTunnelPayload))));
}

void append_frame(std::vector<std::byte>& out, TunnelFrameKind kind, std::uint32_t connection, std::uint32_t number) {
  std::vector<std::byte> payload;
  NetworkWriter(payload).integer(number);
  append_frame(out, kind, connection, payload);
}

std::optional<std::uint32_t> number_of(const TunnelFrame& frame) {
  return frame.payload.size() == 4 ? std::optional(number_at(frame.payload)) : std::nullopt;
}

std::optional<std::string> TunnelFrameReader::receive(std::span<const std::byte> bytes) {
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(begin_));
  begin_ = 0;
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  if (!marked_ && !find_mark() && noise_ > kMaxTunnelNoise)
    return "it prints more than " + std::to_string(kMaxTunnelNoise) + " bytes before the tunnel begins";
  if (marked_ && bytes_.size() - begin_ >= kTunnelHeader) {
    const std::uint32_t size = number_at(std::span(bytes_).subspan(begin_));
    if (size > kMaxTunnelPayload) return "it sends a frame of " + std::to_string(size) + " bytes";
  }
  return std::nullopt;
}

bool TunnelFrameReader::find_mark() {
  const auto mark = std::as_bytes(std::span(kTunnelMark));
  const auto found = std::search(bytes_.begin(), bytes_.end(), mark.begin(), mark.end());
  marked_ = found != bytes_.end();
  if (marked_) {
    begin_ = static_cast<std::size_t>(found - bytes_.begin()) + mark.size();
    return true;
  }
  // Keep the bytes that may begin the mark.
  const std::size_t dropped = bytes_.size() - std::min(bytes_.size(), mark.size() - 1);
  noise_ += dropped;
  begin_ = dropped;
  return false;
}

std::optional<TunnelFrame> TunnelFrameReader::next() {
  if (!marked_) return std::nullopt;
  const auto rest = std::span(std::as_const(bytes_)).subspan(begin_);
  if (rest.size() < kTunnelHeader) return std::nullopt;
  const std::size_t size = number_at(rest);
  if (size > kMaxTunnelPayload || rest.size() < kTunnelHeader + size) return std::nullopt;
  begin_ += kTunnelHeader + size;
  return TunnelFrame{static_cast<TunnelFrameKind>(rest[4]), number_at(rest.subspan(5)),
                     rest.subspan(kTunnelHeader, size)};
}

std::string hello_text(const TunnelHello& hello) {
  std::string text = "protocols";
  for (const unsigned protocol : hello.protocols) text += " " + std::to_string(protocol);
  text += "\nversion " + hello.version + "\nfeatures";
  for (const std::string& feature : hello.features) text += " " + feature;
  return text + "\n";
}

TunnelHello parse_hello(std::string_view text) {
  TunnelHello hello;
  while (!text.empty()) {
    std::string_view line = next_word(text, '\n');
    const std::string_view key = next_word(line, ' ');
    if (key == "version") hello.version = line.substr(0, 64);
    while (!line.empty()) {
      const std::string_view word = next_word(line, ' ');
      if (key == "features" && hello.features.size() < kMaxHelloWords) hello.features.emplace_back(word);
      unsigned number = 0;
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
      if (key == "protocols" && error == std::errc() && end == word.data() + word.size() &&
          hello.protocols.size() < kMaxHelloWords)
        hello.protocols.push_back(number);
    }
  }
  return hello;
}

}  // namespace gs::net
