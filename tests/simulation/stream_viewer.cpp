#include "tests/simulation/stream_viewer.h"

#include "qnv/codecs/payloads.h"
#include "qnv/container/container.h"
#include "qnv/reader/directory_requests.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

namespace gs::simulation {
namespace {

constexpr std::uint64_t kFront = std::uint64_t{1} << 14;

/// Returns the number of vectors of a whole stream, and the sum of their weights.
std::pair<std::size_t, double> sum_of(const qnv::VectorArrays& vectors) {
  double sum = 0;
  for (const float weight : vectors.weights) sum += weight;
  return {vectors.size(), sum};
}

}  // namespace

bool StreamPicture::begin(std::span<const std::byte> front) {
  std::size_t header_bytes = 0;
  bool need_more = false;
  const auto header = qnv::decode_header(front, header_bytes, need_more);
  if (need_more) return false;
  require(std::holds_alternative<qnv::StreamHeader>(header), name_ + ": the header is invalid");
  const auto& known = std::get<qnv::StreamHeader>(header);
  if (qnv::row_of(known).reader == qnv::PayloadReader::levels) {
    auto begun = qnv::LodStream::begin(front);
    require(std::holds_alternative<std::unique_ptr<qnv::LodStream>>(begun), name_ + ": the stream is refused");
    stream_ = std::move(std::get<std::unique_ptr<qnv::LodStream>>(begun));
    feed_ = std::make_shared<app::StreamFeed>(stream_, nullptr);
    return true;
  }
  feed_ = std::make_shared<app::StreamFeed>(std::make_shared<qnv::DirectoryRequests>(known), nullptr);
  decoder_ = std::make_unique<qnv::StreamDecoder>();
  require(decoder_->push(front), name_ + ": the stream is refused");
  return true;
}

void StreamPicture::push(std::span<const std::byte> bytes) {
  if (stream_) return feed_->push(bytes);
  require(decoder_->push(bytes), name_ + ": the stream is refused");
}

void StreamPicture::add_chunk(std::span<const std::byte> chunk) {
  const auto sound = qnv::sound_chunk(chunk);
  require(std::holds_alternative<qnv::SoundChunk>(sound), name_ + ": a chunk is damaged");
  decoder_->add(std::get<qnv::SoundChunk>(sound).type, std::get<qnv::SoundChunk>(sound).payload);
}

void StreamPicture::add_piece(const net::CellEvent& event) {
  if (stream_) return feed_->add_loose(event.name.chunk, event.bytes);
  if (!event.records) return add_chunk(event.bytes);
  const auto head = std::span(event.head).subspan(std::min(event.head.size(), qnv::kChunkHeaderBytes));
  std::vector<std::byte> payload(head.begin(), head.end());
  payload.resize(head.size() + event.offset);
  payload.insert(payload.end(), event.bytes.begin(), event.bytes.end());
  const qnv::ByteRange missing{head.size(), head.size() + event.offset};
  decoder_->add(qnv::ChunkType::records, payload, std::span(&missing, event.offset > 0 ? 1 : 0));
}

void StreamPicture::check(const qnv::VectorArrays& vectors, const Box& box) const {
  const glm::vec3 margin(0.25f * glm::length(box.upper - box.lower));
  require(vectors.normals.size() == vectors.size() && vectors.weights.size() == vectors.size(),
          name_ + ": arrays of different sizes");
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const glm::vec3 p = vectors.positions[i];
    require(
        glm::all(glm::greaterThanEqual(p, box.lower - margin)) && glm::all(glm::lessThanEqual(p, box.upper + margin)),
        name_ + ": a vector is outside the box");
    require(vectors.weights[i] > 0 && std::isfinite(vectors.weights[i]), name_ + ": an invalid weight");
    require(std::abs(glm::length(vectors.normals[i]) - 1) < 0.01f, name_ + ": a normal is no unit vector");
  }
}

void StreamPicture::draw(bool all) {
  if (!feed_) return;
  feed_->apply();
  const Box box = feed_->box();
  const glm::vec3 centre = 0.5f * (box.lower + box.upper), size = box.upper - box.lower;
  if (pictures_ == 0 || random_.chance(0.2)) {
    const glm::vec3 aside(random_.between(-1.0, 1.0), random_.between(-1.0, 1.0), random_.between(-1.0, 1.0));
    view_.eye = centre + aside * size * 2.0f;
    view_.pixels = static_cast<float>(random_.between(100.0, 2000.0));
    view_.budget = random_.chance(0.5) ? 0 : static_cast<std::size_t>(random_.between(std::uint64_t{1000}, 30'000));
    view_.error_pixels = static_cast<float>(random_.between(0.5, 4.0));
    const glm::vec3 inwards = glm::normalize(centre - view_.eye + glm::vec3(1e-3f));
    view_.planes = {};
    if (random_.chance(0.5)) view_.planes[0] = glm::vec4(inwards, -glm::dot(inwards, centre));
  }
  if (all) {
    view_ = {};
    view_.eye = centre + size;
    view_.pixels = 1e9f;
  }
  ++pictures_;
  if (!stream_) {
    feed_->requests()->note(view_);
    feed_->ask();
    if (random_.chance(0.2) || all) {
      const qnv::Geometry geometry = decoder_->geometry();
      require(decoder_->problems().empty(),
              name_ + ": " + (decoder_->problems().empty() ? std::string() : decoder_->problems().front().message));
      require(decoder_->refused_chunks() == 0, name_ + ": refused chunks");
    }
    require(decoder_->vectors() >= most_vectors_, name_ + ": the picture became coarser");
    most_vectors_ = decoder_->vectors();
    return;
  }
  const auto pieces = stream_->cut(view_);
  for (const qnv::Piece& piece : pieces) {
    require(piece.first + piece.count <= piece.splats->size(), name_ + ": a piece ends behind its splats");
    if (random_.chance(0.05)) check(*piece.splats, box);
  }
  require(stream_->problems().empty(),
          name_ + ": " + (stream_->problems().empty() ? std::string() : stream_->problems().front().message));
  feed_->ask();
}

void StreamPicture::check_whole(const Bytes& content) {
  if (stream_) {
    auto opened = qnv::LodStream::open(*content);
    const auto expected = sum_of(std::get<std::unique_ptr<qnv::LodStream>>(opened)->whole());
    require(sum_of(stream_->whole()) == expected, name_ + ": the complete stream has other vectors than its file");
    return;
  }
  qnv::StreamDecoder reference;
  (void)reference.push(*content);
  reference.finish();
  require(decoder_->vectors() == reference.vectors() && decoder_->mesh().triangles == reference.mesh().triangles,
          name_ + ": the complete stream has " + std::to_string(decoder_->vectors()) + " vectors; expected " +
              std::to_string(reference.vectors()));
}

StreamClient::StreamClient(net::LoadRequests& loader, const Content& content, Random random, Trace& trace)
    : loader_(loader),
      content_(content),
      random_(random),
      trace_(trace),
      url_("http://site.example/" + content.name),
      picture_(content.name, Random(random.next())),
      views_(static_cast<std::size_t>(random_.between(std::uint64_t{0}, 40))) {
  net::Request request;
  request.url = url_;
  request.ranges = {{0, kFront}};
  request.priority = 1000;
  request_ = loader_.request(std::move(request));
  row_ = ledger_->begin(url_, "http", nullptr);
}

bool StreamClient::take(net::LoadEvent& event, std::int64_t now) {
  if (const auto* data = std::get_if<net::LoadData>(&event.what); data && !over_) {
    const bool ours = request_ == event.id;
    if (ours) received_ += data->bytes.size();
  }
  if (request_ && *request_ == event.id) {
    take_front(event);
    if (ended_) end(*ended_, now);
    return true;
  }
  const bool taken = ranges_ && ranges_->take(event);
  if (taken && ended_) end(*ended_, now);
  return taken;
}

void StreamClient::take_front(net::LoadEvent& event) {
  if (auto* head = std::get_if<net::LoadHead>(&event.what)) {
    head_ = *head;
  } else if (auto* data = std::get_if<net::LoadData>(&event.what)) {
    if (begun_) return picture_.push(data->bytes);
    front_.insert(front_.end(), data->bytes.begin(), data->bytes.end());
    begun_ = picture_.begin(front_);
  } else if (std::holds_alternative<net::LoadRestarted>(event.what)) {
    loader_.cancel(*request_);
    ended_ = begun_ ? "the file changed on the server" : "the file changed on the server at the start";
  } else if (auto* error = std::get_if<net::LoadError>(&event.what)) {
    request_.reset();
    ended_ = error->message;
  } else {
    request_.reset();
    if (whole_ || received_ == head_.total)
      ended_ = "";
    else
      begin_ranges();
  }
}

void StreamClient::begin_ranges() {
  const std::shared_ptr<app::StreamFeed>& feed = picture_.feed();
  const bool by_view = feed && !feed->requests()->in_stream_order();
  app::RangedStream::Place place;
  place.url = url_;
  place.validator = head_.validator;
  place.front = received_;
  place.directory = feed ? feed->directory() : 0;
  place.total = *head_.total;
  place.ledger = ledger_;
  place.row = row_;
  const auto read_on = [this] {
    net::Request request;
    request.url = url_;
    request.ranges = {{received_, *head_.total}};
    request.validator = head_.validator;
    whole_ = true;
    request_ = loader_.request(std::move(request));
  };
  if (!by_view || place.directory < place.front || place.directory >= place.total) return read_on();
  app::RangedStream::Sink sink;
  sunk_ = !feed->takes_bytes();
  if (sunk_) {
    sink.chunk = [this](const std::vector<std::byte>& chunk) { picture_.add_chunk(chunk); };
    sink.end = [this](const std::optional<std::string>& problem) { ended_ = problem.value_or(""); };
    sink.read_on = read_on;
  }
  ranges_ = std::make_unique<app::RangedStream>(loader_, feed, std::move(place), std::move(sink));
}

void StreamClient::draw(std::int64_t now) {
  if (over_) return;
  const bool all = views_ == 0;
  if (views_ > 0) --views_;
  picture_.draw(all);
  if (ranges_) (void)ranges_->ask_for_more();
  if (ended_) return end(*ended_, now);
  if (!ranges_ || sunk_) return;
  if (ranges_->over()) return end(picture_.feed()->take_problem(), now);
  if (all && ranges_->has_directory() && picture_.complete()) {
    ranges_->cancel();
    end("", now);
  }
}

void StreamClient::end(std::string problem, std::int64_t now) {
  over_ = true;
  problem_ = std::move(problem);
  trace_.note(now, "stream " + content_.name + " ended" + (problem_.empty() ? "" : ": " + problem_));
  if (!problem_.empty()) return;
  const Bytes& version = content_.versions[content_.versions[0]->size() == head_.total ? 0 : 1];
  require(version->size() == head_.total, content_.name + ": the total size is that of no version");
  if (picture_.feed()) picture_.feed()->apply();
  picture_.check_whole(version);
}

}  // namespace gs::simulation
