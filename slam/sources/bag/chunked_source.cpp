#include "slam/sources/bag/chunked_source.h"

#include <utility>

#include "nn/base/counted.h"
#include "nn/base/text.h"

namespace penumbra::slam {

std::string_view ChunkedSource::read(const MessagePlace& place) {
  file_.forget(std::exchange(handed_out_, {}));
  if (place.within == MessagePlace::kUnpacked) return handed_out_ = file_.part(place.at, place.size);
  const std::string_view chunk = file_.chunk(place.at, [&] { return unpack_at(place.at); });
  if (place.within > chunk.size() || place.size > chunk.size() - place.within)
    throw InputError(file_.place(place.at), "the message in its chunk", "another chunk");
  return chunk.substr(place.within, place.size);
}

void ChunkedSource::hand_on(std::size_t topic, std::int64_t time, std::string_view data,
                            const std::optional<Inside>& inside, const Take& take) {
  if (data.size() >= MessagePlace::kUnpacked)
    throw InputError(file_.name(), "a message below 4 GiB", fmt::format("{} bytes", data.size()));
  Message message;
  message.topic = topic;
  message.record_time = time;
  message.bytes = data;
  message.place.size = static_cast<std::uint32_t>(data.size());
  message.place.at = inside ? inside->at : byte_of(data);
  if (inside) message.place.within = static_cast<std::uint32_t>(data.data() - inside->bytes.data());
  count(topic, time);
  ++messages_;
  take(message);
}

void ChunkedSource::note_cut(std::uint64_t at) {
  notes_.push_back(fmt::format("{}: cut off or damaged at byte {} of {}; used: {} before it, with {}",
                               file_.name(), at, file_.bytes().size(), counted(chunks_, "whole chunk"),
                               counted(messages_, "message")));
}

void ChunkedSource::note_damaged(const InputError& error) {
  if (damaged_++ == 0) first_damage_ = printable(error.what(), 300);
}

void ChunkedSource::note_damage() {
  if (damaged_ == 0) return;
  notes_.push_back(fmt::format("damaged: {}; what is whole is used; the first: {}",
                               counted(damaged_, "chunk or record", "chunks or records"), first_damage_));
}

}  // namespace penumbra::slam
