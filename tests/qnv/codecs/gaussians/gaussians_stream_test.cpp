#include "qnv/codecs/gaussians/encode/gaussians_stream.h"

#include "qnv/codecs/gaussians/cluster_code.h"
#include "qnv/codecs/gaussians/harmonics_code.h"
#include "qnv/codecs/gaussians/splat_cluster.h"
#include "qnv/codecs/gaussians/splat_steps.h"
#include "qnv/reader/directory_requests.h"
#include "qnv/reader/loss.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/qnv/splat_clouds.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <variant>
#include <vector>

namespace gs::qnv::gaussians_stream_test {
namespace {

using Bytes = std::vector<std::byte>;

EncodedStream stream_of(const Gaussians& source, EncodeOptions options = {}) {
  auto encoded = encode_gaussians(source, options);
  REQUIRE(std::holds_alternative<EncodedStream>(encoded));
  return std::get<EncodedStream>(std::move(encoded));
}

Gaussians decoded(StreamDecoder& decoder) {
  Geometry geometry = decoder.geometry();
  REQUIRE(geometry.as<Gaussians>());
  return std::move(*geometry.as<Gaussians>());
}

Gaussians decoded(std::span<const std::byte> bytes) {
  StreamDecoder decoder;
  (void)decoder.push(bytes);
  return decoded(decoder);
}

/// Checks what renderers rely on.
void check_sound(const Gaussians& g) {
  const std::size_t n = g.size();
  REQUIRE((g.normals.size() == n && g.weights.size() == n && g.colors.size() == n && g.scales.size() == n &&
           g.rotations.size() == n && g.opacities.size() == n && g.bases.size() == n));
  REQUIRE(g.harmonics.size() == n * harmonic_count(g.degree));
  bool good = true;
  for (std::size_t i = 0; i < n; ++i) {
    const Box& box = g.description.box;
    for (int k = 0; k < 3; ++k)
      good = good && g.positions[i][k] >= box.lower[k] && g.positions[i][k] <= box.upper[k] && g.scales[i][k] >= 0 &&
             std::isfinite(g.scales[i][k]) && std::isfinite(g.bases[i][k]);
    good = good && std::abs(glm::length(g.rotations[i]) - 1) < 1e-4f && g.opacities[i] > 0 && g.opacities[i] <= 1;
    good = good && g.weights[i] > 0 && std::isfinite(g.weights[i]);
  }
  CHECK(good);
}

double opacity_area(const Gaussians& g) {
  double sum = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    const double x = g.scales[i].x, y = g.scales[i].y, z = g.scales[i].z;
    sum += g.opacities[i] * std::sqrt(x * x * y * y + x * x * z * z + y * y * z * z);
  }
  return sum;
}

/// Returns the most similar Gaussian. `scales` are the deviations to find, largest first.
std::size_t most_similar(const Gaussians& all, const Gaussians& source, std::size_t i, const glm::vec3& scales) {
  std::size_t best = 0;
  float least = std::numeric_limits<float>::max();
  for (std::size_t j = 0; j < all.size(); ++j) {
    const float change =
        glm::distance(all.positions[j], source.positions[i]) / scales.x +
        5 * std::abs(std::log(all.scales[j].x / scales.x)) + 5 * std::abs(std::log(all.scales[j].y / scales.y)) +
        5 * std::abs(all.opacities[j] - source.opacities[i]) + glm::distance(all.bases[j], source.bases[i]);
    if (change < least) best = j;
    least = std::min(least, change);
  }
  return best;
}

}  // namespace

TEST_CASE("Gaussians survive a stream within the stated errors") {
  const gaussians::SplatErrors errors = gaussians::splat_errors();
  for (const int degree : {0, 1, 3}) {
    Gaussians source = test::splat_cloud(1500, degree);
    source.antialiased = degree == 1;
    source.description.metadata = {{"title", "cloud"}};
    const EncodedStream stream = stream_of(source);
    CHECK(stream.header.vectors == 1500);
    StreamDecoder decoder;
    (void)decoder.push(stream.bytes);
    decoder.finish();
    CHECK(decoder.problems().empty());
    CHECK(decoder.refused_chunks() == 0);
    const Gaussians back = decoded(decoder);
    check_sound(back);
    REQUIRE(back.size() == 1500);
    CHECK(back.degree == degree);
    CHECK(back.antialiased == source.antialiased);
    CHECK(back.description.metadata.front().second == "cloud");
    double most_place = 0, most_scale = 0, most_opacity = 0, most_color = 0, most_harmonic = 0;
    for (std::size_t i = 0; i < source.size(); ++i) {
      glm::vec3 scales = source.scales[i];
      std::ranges::sort(&scales[0], &scales[0] + 3, std::ranges::greater{});
      const float longest = scales.x;
      const std::size_t j = most_similar(back, source, i, scales);
      const double ratio = std::abs(std::log(static_cast<double>(back.scales[j].x) / longest));
      most_place = std::max<double>(most_place, glm::distance(back.positions[j], source.positions[i]) / longest);
      most_scale = std::max(most_scale, std::exp(ratio) - 1);
      most_opacity = std::max<double>(most_opacity, std::abs(back.opacities[j] - source.opacities[i]));
      const glm::vec3 tint = glm::abs(back.bases[j] - source.bases[i]);
      most_color = std::max<double>(most_color, std::max({tint.x, tint.y, tint.z}));
      const std::size_t per = harmonic_count(degree);
      for (std::size_t k = 0; k < per; ++k) {
        const glm::vec3 change = glm::abs(back.harmonics[j * per + k] - source.harmonics[i * per + k]);
        most_harmonic = std::max<double>(most_harmonic, std::max({change.x, change.y, change.z}));
      }
    }
    CHECK(most_place <= std::sqrt(3.0) * errors.place[1] + 1e-3);
    CHECK(most_scale <= errors.scale[1] + 1e-3);
    CHECK(most_opacity <= errors.opacity[1] + 1e-3);
    CHECK(most_color <= errors.color[1] + 1e-3);
    const gaussians::Precision precision = gaussians::precision_of(stream.header.gaussians, {});
    CHECK(most_harmonic <= gaussians::harmonic_factor(precision) * errors.color[1] + 1e-3);
  }
}

TEST_CASE("every prefix of a stream of Gaussians is a whole picture") {
  const Gaussians source = test::splat_cloud(4000);
  const EncodedStream stream = stream_of(source);
  const double truth = opacity_area(source);
  StreamDecoder decoder;
  std::size_t shown = 0;
  for (std::size_t at = 0; at < stream.bytes.size(); at += 97) {
    (void)decoder.push(std::span(stream.bytes).subspan(at, std::min<std::size_t>(97, stream.bytes.size() - at)));
    if (!decoder.header()) continue;
    const Gaussians part = decoded(decoder);
    REQUIRE(part.size() == decoder.vectors());
    CHECK(part.size() >= shown);
    const bool more = part.size() > shown;
    shown = part.size();
    if (!more) continue;
    check_sound(part);
    // Fewer Gaussians have a similar sum of opacity x area: no hole, and no surplus.
    CHECK(opacity_area(part) > 0.5 * truth);
    CHECK(opacity_area(part) < 2.5 * truth);
    // They reach as far as the source.
    Box box;
    for (const glm::vec3& p : part.positions) box.add(p);
    CHECK(box.size().x > 1.0f);
    CHECK(box.size().y > 0.8f);
  }
  CHECK(shown == 4000);
}

TEST_CASE("streams of Gaussians decode equally in pieces, backwards and after repetition") {
  const EncodedStream stream = stream_of(test::splat_cloud(1200, 2));
  const Gaussians whole = decoded(stream.bytes);
  for (const std::size_t size : {1u, 7u, 1000u}) {
    StreamDecoder decoder;
    for (std::size_t at = 0; at < stream.bytes.size(); at += size)
      (void)decoder.push(std::span(stream.bytes).subspan(at, std::min(size, stream.bytes.size() - at)));
    decoder.finish();
    const Gaussians part = decoded(decoder);
    CHECK(part.positions == whole.positions);
    CHECK(part.harmonics == whole.harmonics);
  }
  std::vector<std::pair<ChunkType, Bytes>> chunks;
  StreamReader reader;
  (void)reader.push(stream.bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type != ChunkType::parity) chunks.emplace_back(type, Bytes(payload.begin(), payload.end()));
  });
  std::mt19937 random(3);
  for (int order = 0; order < 4; ++order) {
    if (order == 0)
      std::ranges::reverse(chunks);
    else
      std::ranges::shuffle(chunks, random);
    StreamDecoder decoder;
    (void)decoder.push(encode_header(stream.header));
    for (const auto& [type, payload] : chunks) decoder.add(type, payload);
    const Gaussians part = decoded(decoder);
    CHECK(part.positions == whole.positions);
    CHECK(part.harmonics == whole.harmonics);
    for (const auto& [type, payload] : chunks)
      if (type == ChunkType::gaussians) decoder.add(type, payload);
    CHECK(decoded(decoder).positions == whole.positions);
  }
}

TEST_CASE("a lost cluster of Gaussians costs its box only") {
  const Gaussians source = test::splat_cloud(6000);
  EncodeOptions options;
  options.parity = 0;
  const EncodedStream stream = stream_of(source, options);
  CHECK(!stream.header.parity);
  const Gaussians whole = decoded(stream.bytes);
  std::vector<std::pair<ChunkType, Bytes>> chunks;
  StreamReader reader;
  (void)reader.push(stream.bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    chunks.emplace_back(type, Bytes(payload.begin(), payload.end()));
  });
  StreamDecoder complete;
  (void)complete.push(stream.bytes);
  const std::vector<DirectoryEntry> entries = complete.directory();
  for (const std::size_t lost : {chunks.size() / 3, chunks.size() / 2}) {
    StreamDecoder decoder;
    (void)decoder.push(encode_header(stream.header));
    for (std::size_t i = 0; i < chunks.size(); ++i)
      if (i != lost) decoder.add(chunks[i].first, chunks[i].second);
    const Gaussians part = decoded(decoder);
    CHECK(decoder.refused_chunks() == 0);
    check_sound(part);
    // The Gaussians outside of the box of the lost cluster are there. Few descendants lie outside of it.
    std::size_t outside = 0, found = 0;
    const Box& box = entries[lost].box;
    for (const glm::vec3& p : whole.positions) {
      bool in = true;
      for (int k = 0; k < 3; ++k) in = in && p[k] >= box.lower[k] && p[k] <= box.upper[k];
      if (in) continue;
      ++outside;
      found += std::ranges::find(part.positions, p) != part.positions.end() ? 1 : 0;
    }
    CHECK(found * 1000 >= outside * 999);
    CHECK(opacity_area(part) > 0.6 * opacity_area(whole));
  }
  // With parity, all come back.
  options.parity = 0.3;
  const EncodedStream safe = stream_of(source, options);
  CHECK(safe.header.parity);
  StreamDecoder decoder;
  (void)decoder.push(drop_packets(safe.bytes, 0.1, 5));
  CHECK(decoder.restored_chunks() > 0);
  CHECK(decoded(decoder).positions == whole.positions);
}

TEST_CASE("streams of Gaussians end where the options ask") {
  const Gaussians source = test::splat_cloud(5000, 1);
  EncodeOptions options;
  options.max_bytes = 15'000;
  const EncodedStream small = stream_of(source, options);
  CHECK(small.bytes.size() <= 15'000);
  CHECK(small.bytes.size() > 12'000);
  CHECK(decoded(small.bytes).size() == small.header.vectors);
  options = {};
  options.vectors = 800;
  const EncodedStream few = stream_of(source, options);
  CHECK(few.header.vectors >= 800);
  CHECK(few.header.vectors < 1500);
  StreamDecoder bounded(900);
  (void)bounded.push(stream_of(source).bytes);
  CHECK(bounded.full());
  CHECK(bounded.refused_chunks() == 0);
  CHECK(bounded.vectors() <= 900);
  CHECK(bounded.vectors() > 400);
}

TEST_CASE("views request the Gaussians in their box first") {
  const EncodedStream stream = stream_of(test::splat_cloud(6000));
  DirectoryRequests requests(stream.header);
  CHECK(!requests.in_stream_order());
  REQUIRE(requests.set_directory(std::span(stream.bytes).subspan(stream.header.directory)));
  CHECK(requests.wanted().size() == stream.header.chunks);
  for (const DirectoryEntry& entry : [&] {
         StreamDecoder decoder;
         (void)decoder.push(stream.bytes);
         return decoder.directory();
       }()) {
    CHECK(entry.bytes <= gaussians::kMostClusterBytes + kChunkHeaderBytes);
    CHECK(!entry.box.empty());
  }
}

TEST_CASE("encoders refuse Gaussians that are not finite, and accept extreme ones") {
  CHECK(std::holds_alternative<EncodeError>(encode_gaussians(Gaussians(), {})));
  Gaussians source = test::splat_cloud(50);
  source.positions[3].x = std::numeric_limits<float>::quiet_NaN();
  CHECK(std::holds_alternative<EncodeError>(encode_gaussians(source, {})));
  source = test::splat_cloud(50);
  source.scales[4] = glm::vec3(0);
  source.scales[5] = glm::vec3(1e10f, 0, 0);
  source.bases[6] = glm::vec3(1000, -1000, 0);
  source.opacities[7] = 1e-6f;
  const Gaussians back = decoded(stream_of(source).bytes);
  CHECK(back.size() == 50);
  check_sound(back);
  for (const std::size_t count : {1u, 2u, 3u}) {
    const Gaussians few = decoded(stream_of(test::splat_cloud(count)).bytes);
    CHECK(few.size() == count);
    check_sound(few);
  }
}

TEST_CASE("damaged streams of Gaussians decode to sound Gaussians") {
  const EncodedStream stream = stream_of(test::splat_cloud(120, 2));
  std::mt19937 random(11);
  std::vector<std::pair<ChunkType, Bytes>> chunks;
  StreamReader reader;
  (void)reader.push(stream.bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    chunks.emplace_back(type, Bytes(payload.begin(), payload.end()));
  });
  // Bits of the first cluster, and random ones of all chunks. Checksums do not protect these calls.
  const std::size_t bits = 8 * chunks.front().second.size();
  for (std::size_t bit = 0; bit < bits + 400; bit += bit < bits ? 3 : 1) {
    StreamDecoder decoder;
    (void)decoder.push(encode_header(stream.header));
    const std::size_t which = bit < bits ? 0 : random() % chunks.size();
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      Bytes payload = chunks[i].second;
      const std::size_t at = bit < bits ? bit : random() % (8 * payload.size());
      if (i == which) payload[at / 8] ^= static_cast<std::byte>(1u << at % 8);
      decoder.add(chunks[i].first, payload);
    }
    if (bit % 8 == 0 || bit >= bits) check_sound(decoded(decoder));
  }
  // A flipped bit in the file costs a chunk.
  for (int i = 0; i < 60; ++i) {
    Bytes bytes = stream.bytes;
    const std::size_t at = 200 + random() % (bytes.size() - 200);
    bytes[at] ^= static_cast<std::byte>(1u << random() % 8);
    check_sound(decoded(bytes));
  }
}

TEST_CASE("decoders of Gaussians refuse hostile heads and headers") {
  GaussianCoding coding;
  coding.degree = 4;
  CHECK(!decode_gaussian_coding(encode_gaussian_coding(coding)));
  coding.degree = 3;
  coding.finest = -1;
  CHECK(!decode_gaussian_coding(encode_gaussian_coding(coding)));
  coding.finest = 640;
  CHECK(!decode_gaussian_coding(encode_gaussian_coding(coding)));
  coding.finest = 300;
  coding.steps = 33;
  CHECK(!decode_gaussian_coding(encode_gaussian_coding(coding)));
  coding.steps = -32;
  coding.version = GaussianCoding::Version::trained;
  coding.fine = 5;
  CHECK(!decode_gaussian_coding(encode_gaussian_coding(coding)));
  coding.fine = 4;
  const Bytes section = encode_gaussian_coding(coding);
  CHECK(decode_gaussian_coding(section) == coding);
  for (std::size_t n = 0; n < section.size(); ++n) CHECK(!decode_gaussian_coding(std::span(section).first(n)));
  coding.fine = 0;
  coding.version = GaussianCoding::Version::tuned;
  CHECK(decode_gaussian_coding(encode_gaussian_coding(coding)) == coding);
  coding.version = static_cast<GaussianCoding::Version>(3);
  CHECK(!decode_gaussian_coding(encode_gaussian_coding(coding)));
  using gaussians::ClusterHead;
  const auto valid = [](const ClusterHead& head) {
    return gaussians::parse_cluster(gaussians::pack(head, {})).has_value();
  };
  CHECK(valid({0, ClusterHead::kNoParent, 0, 1, 0}));
  CHECK(valid({5, 2, 3, 4, 1}));
  CHECK(!valid({0, ClusterHead::kNoParent, 0, 2, 0}));
  CHECK(!valid({0, ClusterHead::kNoParent, 0, 1, 1}));
  CHECK(!valid({5, 5, 3, 4, 1}));
  CHECK(!valid({5, 2, 3, 0, 1}));
  CHECK(!valid({5, 2, 3, 4, 0}));
  CHECK(!valid({5, 2, 1u << 20, 4, 1}));
  CHECK(!gaussians::parse_cluster(Bytes(1201)));
  CHECK(!gaussians::parse_cluster({}));
  CHECK(!gaussians::parse_harmonics(gaussians::pack(gaussians::HarmonicsHead{1, 2, 0}, {})));
  // Clusters that wait for others do not fill memory.
  StreamHeader header;
  header.payload = Payload::gaussians;
  header.description.box = {glm::vec3(0), glm::vec3(1)};
  StreamDecoder decoder(1000);
  (void)decoder.push(encode_header(header));
  const Bytes rest(1100, std::byte{0x55});
  for (std::uint32_t i = 0; i < 60'000; ++i)
    decoder.add(ChunkType::gaussians, gaussians::pack(ClusterHead{i + 2, 1, 0, 1, 1}, rest));
  CHECK(decoder.refused_chunks() > 0);
  CHECK(decoder.vectors() == 0);
}

TEST_CASE("scales and opacities have the nearest codes") {
  for (const double scale : {1e-9, 0.001, 0.37, 1.0, 90.0, 1e9})
    CHECK(std::abs(std::log2(gaussians::scale_of(gaussians::scale_code(scale)) / scale)) <= 1.0 / 16 + 1e-9);
  CHECK(gaussians::scale_code(0) == 0);
  CHECK(gaussians::scale_code(1e300) == gaussians::kMostScale);
  for (const double opacity : {0.01, 0.3, 0.99, 1.0})
    CHECK(std::abs(gaussians::opacity_of(gaussians::opacity_code(opacity)) - opacity) <= 0.5 / 63 + 0.01);
  for (const glm::dvec3 rgb : {glm::dvec3(0.1, 0.5, -0.3), glm::dvec3(1, 1, 1), glm::dvec3(-2, 0, 0.7)}) {
    const glm::dvec3 back = gaussians::rgb_of(gaussians::color_code(rgb, 1e-4), 1e-4);
    CHECK(glm::length(back - rgb) < 4e-4);
  }
}

}  // namespace gs::qnv::gaussians_stream_test
