#include "app/confined/data_child.h"

#include "app/base/local_file.h"
#include "app/confined/child_channel.h"

#include <new>
#include <optional>
#include <string>
#include <utility>

namespace gs::app {
namespace {

/// Server of the data of one file.
class DataServer {
 public:
  explicit DataServer(OpenData& data) : data_(data) {}
  /// Answers one request. Returns false if the parent ended, or sent what it never sends.
  [[nodiscard]] bool answer_request();

 private:
  void open(const DecodeRequest& request, DecodeAnswer& answer);
  void read_slices(const DecodeRequest& request, DecodeAnswer& answer);
  void read_box(const DecodeRequest& request, DecodeAnswer& answer);

  OpenData& data_;
  SharedMemory result_{net::Descriptor(kDecoderResult), true};
  std::vector<std::byte> reply_;
  bool opened_ = false;
};

void DataServer::open(const DecodeRequest& request, DecodeAnswer& answer) {
  if (std::exchange(opened_, true)) return set_error(answer, "a file is open already");
  const auto head = request.count > 0 ? result_.map(static_cast<std::size_t>(request.count)) : std::span<std::byte>();
  const std::vector<std::byte> copy(head.begin(), head.end());  // the parent reuses the memory for files
  auto file = net::map_descriptor(net::Descriptor(kDecoderInput));
  if (copy.size() != request.count || !file) return set_error(answer, "it cannot be mapped");
  reply_ = data_.open(copy, shared_bytes(std::move(*file)),
                      [this](const std::string& reference) { return ask_parent_for_file(result_, reference); });
  answer.good = 1;
  answer.count = reply_.size();
}

void DataServer::read_slices(const DecodeRequest& request, DecodeAnswer& answer) {
  const std::uint64_t end = request.offset + request.bytes * request.count;
  const auto room = end > 0 ? result_.map(static_cast<std::size_t>(end)) : std::span<std::byte>();
  if (room.size() != end) return set_error(answer, "no memory for slices");
  for (std::uint64_t i = 0; i < request.count; ++i) {
    const auto to = room.subspan(static_cast<std::size_t>(request.offset + i * request.bytes),
                                 static_cast<std::size_t>(request.bytes));
    if (!data_.read_slice(request.source, request.first + i, to)) return set_error(answer, "a slice cannot be read");
    answer.good = 1;
    answer.count = i + 1;
  }
  set_error(answer, data_.trouble());
}

void DataServer::read_box(const DecodeRequest& request, DecodeAnswer& answer) {
  const auto room = request.bytes > 0 ? result_.map(static_cast<std::size_t>(request.bytes)) : std::span<std::byte>();
  if (room.size() != request.bytes) return set_error(answer, "no memory for voxels");
  if (!data_.read_box(request.source, request.box, room)) return set_error(answer, "a box of voxels cannot be read");
  answer.good = 1;
  answer.count = 1;
  set_error(answer, data_.trouble());
}

bool DataServer::answer_request() {
  DecodeRequest request;
  if (!receive_request(request)) return false;
  DecodeAnswer answer;
  try {
    if (request.operation == DecodeOperation::open_data)
      open(request, answer);
    else if (request.operation == DecodeOperation::read_slices)
      read_slices(request, answer);
    else if (request.operation == DecodeOperation::read_box)
      read_box(request, answer);
    else
      return false;
  } catch (const std::bad_alloc&) {
    answer = {};
    set_error(answer, "not enough memory to decode it");
  }
  if (!send_answer(answer)) return false;
  return request.operation != DecodeOperation::open_data || answer.good != 1 ||
         send_results(result_, std::exchange(reply_, {}));
}

}  // namespace

void serve_data(OpenData& data) {
  DataServer server(data);
  while (server.answer_request()) {
  }
}

}  // namespace gs::app
