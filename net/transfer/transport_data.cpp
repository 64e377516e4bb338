#include "net/base/hexadecimal.h"
#include "net/transfer/local_transport.h"

#include <algorithm>

namespace gs::net {
namespace {

int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  if (c == '/' || c == '_') return 63;
  return -1;
}

std::vector<std::byte> percent_decoded(std::string_view text) {
  std::vector<std::byte> result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    int value = static_cast<unsigned char>(text[i]);
    if (text[i] == '%' && i + 2 < text.size()) {
      const int high = hexadecimal_value(text[i + 1]), low = hexadecimal_value(text[i + 2]);
      if (high >= 0 && low >= 0) {
        value = high * 16 + low;
        i += 2;
      }
    }
    result.push_back(static_cast<std::byte>(value));
  }
  return result;
}

std::optional<std::vector<std::byte>> base64_decoded(const std::vector<std::byte>& text) {
  std::vector<std::byte> result;
  result.reserve(text.size() / 4 * 3 + 3);
  unsigned bits = 0, count = 0;
  bool ended = false;
  for (const std::byte raw : text) {
    const char c = static_cast<char>(raw);
    if (c == ' ' || (c >= '\t' && c <= '\r')) continue;
    if (c == '=') {
      ended = true;
      continue;
    }
    const int value = base64_value(c);
    if (value < 0 || ended) return std::nullopt;
    bits = (bits << 6 | static_cast<unsigned>(value)) & 0xffffff;
    if (++count % 4 != 1) result.push_back(static_cast<std::byte>(bits >> (6 - 2 * ((count - 1) % 4))));
  }
  if (count % 4 == 1) return std::nullopt;
  return result;
}

bool is_base64_mark(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower == "base64";
}

struct DataTransfer : LocalTransfer {
  std::optional<DataUrl> data;  // nullopt until the head was delivered
};

/// Transport of data: URLs. Delivers the bytes in the step after the start.
class DataTransport final : public LocalTransport<DataTransfer> {
  std::optional<TransferEnd> advance(TransferId id, DataTransfer& transfer, TransferSink& sink) override {
    constexpr std::size_t kBlock = std::size_t{64} << 10;
    std::optional<TransferEnd> end;
    if (!transfer.data) {
      transfer.data = decode_data_url(transfer.request.url);
      if (!transfer.data)
        return failure(LoadErrorKind::bad_request,
                       "malformed data: URL; expected data:[type][;base64],content (RFC 2397)");
      ResponseHead head;
      head.content_type = transfer.data->media_type;
      end = deliver_head(id, transfer, std::move(head), transfer.data->bytes.size(), sink);
    }
    while (!end && !transfer.over && !transfer.paused) {
      const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(kBlock, transfer.end - transfer.next));
      end = deliver(id, transfer,
                    std::span(transfer.data->bytes).subspan(static_cast<std::size_t>(transfer.next), count), sink);
    }
    return end;
  }
};

}  // namespace

std::optional<DataUrl> decode_data_url(std::string_view url) {
  const std::size_t colon = url.find(':'), comma = url.find(',');
  if (colon == std::string_view::npos || comma == std::string_view::npos || comma < colon) return std::nullopt;
  DataUrl result;
  std::string_view kind = url.substr(colon + 1, comma - colon - 1), content = url.substr(comma + 1);
  if (!content.starts_with('#')) content = content.substr(0, std::min(content.find('#'), content.size()));
  const std::size_t mark = kind.rfind(';');
  const bool base64 = mark != std::string_view::npos && is_base64_mark(kind.substr(mark + 1));
  if (base64) kind = kind.substr(0, mark);
  result.media_type = kind.empty() ? "text/plain;charset=US-ASCII" : std::string(kind);
  if (result.media_type.starts_with(';')) result.media_type.insert(0, "text/plain");
  result.bytes = percent_decoded(content);
  if (!base64) return result;
  auto decoded = base64_decoded(result.bytes);
  if (!decoded) return std::nullopt;
  result.bytes = std::move(*decoded);
  return result;
}

std::unique_ptr<Transport> make_data_transport() { return std::make_unique<DataTransport>(); }

}  // namespace gs::net
