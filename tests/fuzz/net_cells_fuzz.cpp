// Fuzzes the datagrams of cells. A server and a client must accept any datagrams in any order. The input is a sequence
// of datagrams. Two bytes before each give its length; their high bit selects the server instead of the client.
#include "net/cells/cell_receiver.h"
#include "net/cells/cell_sender.h"

#include "tests/fuzz/net_targets.h"

#include <memory>

using namespace gs::net;

namespace gs::fuzz {
namespace {

class Source : public CellSource {
 public:
  std::uint32_t version() const override { return 1; }
  std::span<const std::byte> base() const override { return base_; }
  std::size_t streams() const override { return 2; }
  bool records(std::size_t stream) const override { return stream == 0; }
  std::uint32_t chunks(std::size_t) const override { return 3; }
  std::optional<CellBox> box(std::size_t, std::uint32_t) const override { return std::nullopt; }
  std::optional<CellChunk> chunk(std::size_t stream, std::uint32_t) override {
    return CellChunk{std::vector<std::byte>(stream == 0 ? 58 : 0), std::vector<std::byte>(1000)};
  }

 private:
  std::vector<std::byte> base_ = std::vector<std::byte>(300);
};

class Library : public CellLibrary {
 public:
  std::variant<std::shared_ptr<CellSource>, std::string> open(const std::string&) override {
    return std::make_shared<Source>();
  }
};

}  // namespace

bool run_cell_datagrams(std::span<const std::byte> input) {
  CellServerOptions options;
  options.secret = {1, 2};
  CellServer server(options, std::make_shared<Library>());
  CellClientOptions client_options;
  client_options.nonce = 1;
  CellClient client(client_options);
  CellWish wish;
  wish.path = "a";
  wish.repair = true;
  Instant now{1000};
  client.want(0, wish, now);
  // Start a session before the first datagram of the input.
  for (int i = 0; i < 6; ++i) {
    while (const auto bytes = client.next(now)) server.receive({}, *bytes, now);
    while (const auto out = server.next(now)) client.receive(out->bytes, now);
    now += Instant(1000);
  }
  for (int turn = 0; turn < 256 && input.size() >= 2; ++turn) {
    const std::size_t word = std::to_integer<std::size_t>(input[0]) << 8 | std::to_integer<std::size_t>(input[1]);
    const std::size_t length = std::min<std::size_t>(word & 0x7fff, input.size() - 2);
    const auto bytes = input.subspan(2, length);
    input = input.subspan(2 + length);
    if ((word & 0x8000) != 0)
      server.receive({}, bytes, now);
    else
      client.receive(bytes, now);
    for (int i = 0; i < 64; ++i) {
      if (!client.next(now)) break;
      require(i < 63);  // the exchange must end
    }
    for (int i = 0; i < 64 && server.next(now); ++i) continue;
    for (const CellEvent& event : client.take_events())
      require(event.kind != CellEvent::Kind::piece || event.offset + event.bytes.size() <= event.total);
    now += Instant(5000);
  }
  return input.empty();
}

}  // namespace gs::fuzz
