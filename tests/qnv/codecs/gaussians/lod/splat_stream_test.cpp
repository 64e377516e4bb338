#include "tests/qnv/codecs/gaussians/lod/splat_stream_helpers.h"

namespace gs::qnv::splat_stream_test {

TEST_CASE("the finest cut of a stream of Gaussians has all of its splats") {
  for (const int degree : {0, 2}) {
    const EncodedStream encoded = encoded_cloud(3000, degree);
    const Gaussians all = decoded(encoded.bytes);
    for (const bool in_memory : {true, false}) {
      const Stream stream =
          opened(in_memory ? SplatStream::open(encoded.bytes) : SplatStream::open(memory_source(encoded.bytes)));
      CHECK(stream->problems().empty());
      const Gaussians cut = gathered(stream->cut(closest_view()));
      CHECK_FALSE(stream->pending());
      CHECK(stream->wanted().empty());
      CHECK(cut.degree == degree);
      CHECK(sorted_numbers(cut) == sorted_numbers(all));
      const Gaussians whole = stream->whole().decode(10'000);
      CHECK(sorted_numbers(whole) == sorted_numbers(all));
    }
  }
}

TEST_CASE("cuts of Gaussians are coarser from far away and within a budget") {
  const Stream stream = opened(SplatStream::open(encoded_cloud(5000).bytes));
  const double truth = opacity_area(gathered(stream->cut(closest_view())));
  std::size_t last = 6000;
  for (const float away : {2.0f, 300.0f, 2000.0f, 20'000.0f}) {
    const Gaussians cut = gathered(stream->cut(view_from(away)));
    CHECK(cut.size() <= last);
    last = cut.size();
    CHECK(opacity_area(cut) > 0.5 * truth);
    CHECK(opacity_area(cut) < 2.5 * truth);
  }
  CHECK(last < 200);
  for (const std::size_t budget : {100u, 700u, 2000u}) {
    LodView view = closest_view();
    view.budget = budget;
    const Gaussians cut = gathered(stream->cut(view));
    CHECK(cut.size() <= budget);
    CHECK(cut.size() > budget / 3);
    CHECK(opacity_area(cut) > 0.5 * truth);
  }
}

TEST_CASE("viewports have independent cuts of Gaussians") {
  const Stream stream = opened(SplatStream::open(encoded_cloud(4000).bytes));
  const std::vector<SplatRun> near = stream->cut(view_from(2, 0)), far = stream->cut(view_from(3000, 1));
  CHECK(count_of(near) > 4 * count_of(far));
  CHECK(stream->cut(view_from(2, 0)) == near);
  CHECK(stream->cut(view_from(3000, 1)) == far);
  CHECK(stream->views().size() == 2);
  stream->forget(1);
  CHECK(stream->views().size() == 1);
}

TEST_CASE("a view of a part reads only that part of a stream of Gaussians") {
  const EncodedStream encoded = encoded_cloud(24'000, 1);
  const auto source = std::make_shared<CountingSource>(encoded.bytes);
  const Stream stream = opened(SplatStream::open(source));
  LodView view = closest_view();
  view.planes[0] = {-1, 0, 0, -0.8f};  // x <= -0.8
  const std::size_t before = source->read_;
  const Gaussians cut = gathered(stream->cut(view));
  CHECK(source->read_ - before < encoded.bytes.size() * 3 / 4);
  // All splats there are final.
  const Gaussians all = decoded(encoded.bytes);
  const auto inside = [](const Gaussians& some) {
    return std::ranges::count_if(some.positions, [](const glm::vec3& p) { return p.x < -0.81f; });
  };
  CHECK(inside(cut) == inside(all));
  CHECK(cut.size() < all.size() / 2);
}

TEST_CASE("cuts of Gaussians are the same with little memory") {
  const EncodedStream encoded = encoded_cloud(12'000, 1);
  const Stream ample = opened(SplatStream::open(memory_source(encoded.bytes))),
               tight = opened(SplatStream::open(memory_source(encoded.bytes)));
  SplatLimits limits;
  limits.cache_bytes = 200'000;
  tight->set_limits(limits);
  for (const float x : {-0.9f, 0.9f, -0.9f}) {
    LodView view = closest_view();
    view.planes[0] = {x < 0 ? -1.0f : 1.0f, 0, 0, -0.7f};
    const std::vector<Numbers> expected = sorted_numbers(gathered(ample->cut(view)));
    CHECK(sorted_numbers(gathered(tight->cut(view))) == expected);
    CHECK(expected.size() > 500);
  }
  const SplatStatistics kept = ample->statistics(), freed = tight->statistics();
  CHECK(freed.cached_bytes < kept.cached_bytes * 2 / 3);
  // A distant view needs few clusters, so the memory falls below the limit.
  (void)tight->cut(view_from(1000));
  CHECK(tight->statistics().cached_bytes <= limits.cache_bytes);
  limits.cut_bytes = 500 * bytes_of_splat(1);
  tight->set_limits(limits);
  CHECK(count_of(tight->cut(closest_view())) <= 500);
}

TEST_CASE("keeps the Gaussians of a fine cut through a coarse one, and frees the states for finer cuts first") {
  const EncodedStream encoded = encoded_cloud(12'000);
  const Stream stream = opened(SplatStream::open(memory_source(encoded.bytes)));
  LodView fine = closest_view();
  fine.budget = 6000;
  const std::size_t count = count_of(stream->cut(fine));
  CHECK(count > 5000);
  SplatLimits limits;
  limits.cache_bytes = stream->statistics().cached_bytes * 4 / 5;
  stream->set_limits(limits);
  const std::size_t splats = stream->statistics().cached_splats;
  CHECK(count_of(stream->cut(view_from(1000))) < count / 4);
  CHECK(stream->statistics().cached_bytes <= limits.cache_bytes);
  CHECK(stream->statistics().cached_splats == splats);
  CHECK(count_of(stream->cut(fine)) == count);
  CHECK(stream->statistics().decoded == 0);
  // Finer cuts decode the states again.
  CHECK(count_of(stream->cut(closest_view())) == 12'000);
}

TEST_CASE("views request the chunks of Gaussians that they need") {
  const EncodedStream encoded = encoded_cloud(12'000, 1);
  const auto chunks = chunks_of(encoded);
  const Stream stream = opened(SplatStream::begin(std::span(encoded.bytes).first(2000)));
  REQUIRE(stream->set_directory(directory_bytes(encoded)));
  LodView view = closest_view();
  view.planes[0] = {0, 1, 0, -0.5f};
  std::size_t received = 0, count = 0;
  for (int round = 0; round < 100; ++round) {
    count = std::max(count, count_of(stream->cut(view)));
    const auto wanted = stream->wanted();
    if (wanted.empty()) break;
    for (std::size_t i = 0; i < std::min<std::size_t>(wanted.size(), 40); ++i) {
      const auto chunk = std::ranges::find(chunks, wanted[i].offset, &std::pair<std::uint64_t, Bytes>::first);
      REQUIRE(chunk != chunks.end());
      CHECK(chunk->second.size() == wanted[i].bytes);
      CHECK(stream->add(chunk->first, chunk->second));
      received += chunk->second.size();
    }
  }
  CHECK(stream->wanted().empty());
  CHECK(received < encoded.bytes.size() * 3 / 4);
  // The splats in view are those of the whole stream.
  const auto in_view = [](const Gaussians& all) {
    std::vector<Numbers> numbers = sorted_numbers(all);
    std::erase_if(numbers, [](const Numbers& one) { return one[1] < 0.55f; });
    return numbers;
  };
  CHECK(in_view(gathered(stream->cut(view))) == in_view(decoded(encoded.bytes)));
}

TEST_CASE("views request descendants of missing clusters of Gaussians, and no more than they need") {
  const EncodedStream encoded = encoded_cloud(20'000);
  const auto chunks = chunks_of(encoded);
  const auto directory = directory_bytes(encoded);
  /// Requests that a view makes until it has all chunks, if each request gets all of its chunks.
  struct Requests {
    int count = 0;
    std::size_t bytes = 0;
  };
  const auto requests_of = [&](const LodView& view) {
    const Stream stream = opened(SplatStream::begin(std::span(encoded.bytes).first(600)));
    REQUIRE(stream->set_directory(directory));
    Requests made;
    for (; made.count < 100; ++made.count) {
      (void)stream->cut(view);
      const auto wanted = stream->wanted();
      if (wanted.empty()) break;
      for (const ChunkRange& range : wanted) {
        const auto chunk = std::ranges::find(chunks, range.offset, &std::pair<std::uint64_t, Bytes>::first);
        REQUIRE(chunk != chunks.end());
        REQUIRE(stream->add(chunk->first, chunk->second));
        made.bytes += range.bytes;
      }
    }
    return made;
  };
  std::uint8_t levels = 0;
  const Stream whole = opened(SplatStream::open(encoded.bytes));
  for (const DirectoryEntry& entry : directory_of(directory, whole->header())) levels = std::max(levels, entry.level);
  REQUIRE(levels >= 4);
  CHECK(requests_of(closest_view()).count < levels);
  const Requests far = requests_of(view_from(300));
  CHECK(far.bytes < encoded.bytes.size() / 4);
}

TEST_CASE("Gaussians of chunks in any order give the same cut") {
  const EncodedStream encoded = encoded_cloud(2500, 2);
  auto chunks = chunks_of(encoded);
  const std::vector<Numbers> expected = sorted_numbers(decoded(encoded.bytes));
  std::size_t header_bytes = 0;
  bool need_more = false;
  (void)decode_header(encoded.bytes, header_bytes, need_more);
  std::mt19937 random(5);
  for (int order = 0; order < 3; ++order) {
    std::ranges::shuffle(chunks, random);
    const Stream stream = opened(SplatStream::begin(std::span(encoded.bytes).first(header_bytes)));
    if (order > 0) REQUIRE(stream->set_directory(directory_bytes(encoded)));
    std::size_t i = 0;
    for (const auto& [offset, chunk] : chunks) {
      CHECK(stream->add(offset, chunk));
      if (++i % 10 == 0) (void)stream->cut(closest_view());
    }
    stream->finish();
    CHECK(sorted_numbers(gathered(stream->cut(closest_view()))) == expected);
    CHECK(stream->problems().empty());
  }
}

TEST_CASE("coarse Gaussians of a cut have the harmonics that were received") {
  const EncodedStream stream = encoded_cloud(6000, 2);
  bool coarse = false;
  for (const std::size_t bytes : {9'000u, 25'000u, 60'000u, 120'000u}) {
    const std::span<const std::byte> part =
        std::span(stream.bytes).first(std::min<std::size_t>(bytes, stream.bytes.size()));
    const Gaussians expected = decoded(part);
    coarse = coarse || (expected.degree == 2 && expected.size() < 6000);
    const Stream splats = opened(SplatStream::open(part));
    CHECK(sorted_numbers(gathered(splats->cut(closest_view()))) == sorted_numbers(expected));
    // Adds the chunks one by one, with cuts between them.
    const Stream growing = opened(SplatStream::begin(part.first(1000)));
    for (std::size_t at = 1000; at < part.size(); at += 4000) {
      growing->push(part.subspan(at, std::min<std::size_t>(4000, part.size() - at)));
      (void)growing->cut(closest_view());
    }
    CHECK(sorted_numbers(gathered(growing->cut(closest_view()))) == sorted_numbers(expected));
  }
  CHECK(coarse);
}

TEST_CASE("decoding of Gaussians continues in later cuts") {
  const Stream stream = opened(SplatStream::open(encoded_cloud(6000).bytes));
  LodView view = closest_view();
  view.most_decoded = 700;
  std::size_t last = 0, cuts = 0;
  do {
    const std::size_t count = count_of(stream->cut(view));
    CHECK(count >= last);
    CHECK(stream->statistics().decoded < 2500);
    last = count;
  } while (stream->pending() && ++cuts < 100);
  CHECK(cuts > 4);
  CHECK(last == 6000);
}

TEST_CASE("changes of a cut of Gaussians fade") {
  const Stream stream = opened(SplatStream::open(encoded_cloud(6000).bytes));
  const std::size_t coarse = count_of(stream->cut(view_from(3000), 10.0));
  CHECK_FALSE(stream->fading());
  double time = 10, last = 0;
  bool first = true;
  for (int frame = 0; frame < 20; ++frame, time += 0.02) {
    const std::vector<SplatRun> runs = stream->cut(view_from(8), time);
    double present = 0;
    for (const SplatRun& run : runs) {
      CHECK(run.presence > 0);
      CHECK(run.presence <= 1);
      present += double{run.presence} * run.count;
    }
    if (first) CHECK(present == Approx(static_cast<double>(coarse)));
    CHECK(present >= last - 1e-3);
    last = present;
    first = false;
  }
  CHECK_FALSE(stream->fading());
  const Stream other = opened(SplatStream::open(encoded_cloud(6000).bytes));
  CHECK(sorted_numbers(gathered(stream->cut(view_from(8), time))) ==
        sorted_numbers(gathered(other->cut(view_from(8)))));
  // Without a clock or without fades, the change is immediate.
  CHECK(gathered(stream->cut(view_from(3000), time, false)).size() == coarse);
  CHECK_FALSE(stream->fading());
  (void)stream->cut(view_from(8), time);
  CHECK(stream->fading());
  CHECK(count_of(stream->cut(view_from(3000))) < count_of(other->cut(view_from(8))) / 2);
  CHECK_FALSE(stream->fading());
}

TEST_CASE("received Gaussians fade in") {
  const EncodedStream encoded = encoded_cloud(6000);
  const Stream stream = opened(SplatStream::begin(std::span(encoded.bytes).first(9000)));
  (void)stream->cut(view_from(2), 1.0);
  stream->push(std::span(encoded.bytes).subspan(9000));
  (void)stream->cut(view_from(2), 1.1);
  CHECK(stream->fading());
  (void)stream->cut(view_from(2), 1.5);
  CHECK_FALSE(stream->fading());
}

TEST_CASE("an overview of Gaussians has their extent") {
  const Stream stream = opened(SplatStream::open(encoded_cloud(5000).bytes));
  const Gaussians some = stream->overview(1000);
  CHECK(some.size() <= 1000);
  CHECK(some.size() > 300);
  Box box;
  for (const glm::vec3& p : some.positions) box.add(p);
  CHECK(box.size().x > 2);
  CHECK(box.size().y > 1.4f);
}

}  // namespace gs::qnv::splat_stream_test
