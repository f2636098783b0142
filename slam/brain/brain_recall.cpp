// How the robot knows places again.
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "slam/brain/brain.h"

namespace penumbra::slam::brain {

// Nodes right here, where the robot knows where it is: no template needs to be compared.
std::optional<Brain::Candidate> Brain::nearby(const Look& look) {
  if (!on_known_ground_ || settings_.proof != PlaceProof::geometry) return std::nullopt;
  constexpr double kLargestTurn = 0.5;  // radians
  constexpr std::size_t kMostTried = 3;
  const PlanePose here = believed(look.since_anchor);
  std::vector<std::pair<double, int>> near;  // metres, node
  for (int i = 0; i < left_nodes(); ++i) {
    const PlanePose& pose = map_.node(i).pose;
    const double distance = distance_between(here, pose);
    if (distance < 2.5 * keyframe_distance() &&
        std::abs(wrapped_angle(here.heading - pose.heading)) <= kLargestTurn)
      near.emplace_back(distance, i);
  }
  std::sort(near.begin(), near.end());
  for (std::size_t n = 0; n < std::min(near.size(), kMostTried); ++n) {
    std::optional<Candidate> place =
        prove(look, {{.node = near[n].second, .similarity = 1.0, .activity = 1.0, .proven = {}}});
    if (place) return place;
  }
  return std::nullopt;
}

// Nodes are in the order in which they were made: so many of the first are of places that the robot has left.
int Brain::left_nodes() const {
  const double since = way_ - settings_.away * keyframe_distance();
  return static_cast<int>(std::lower_bound(way_of_.begin(), way_of_.end(), since) - way_of_.begin());
}

// Places like the view, each the best of its neighbourhood, by the activity of their place cells.
std::vector<Brain::Candidate> Brain::familiar(const Look& look, BrainResult& result) {
  const auto scope = timer_.measure("compare");
  memory_.query(look.view, left_nodes(), matches_);
  if (!matches_.empty()) {
    result.most_similar = matches_.front().number;
    result.similarity = matches_.front().similarity;
  }
  const PlanePose here = believed(look.since_anchor);
  std::vector<Candidate> candidates;
  for (const TemplateMatch& match : matches_) {
    if (match.similarity < settings_.least_similarity) break;
    const Node& node = map_.node(match.number);
    const double off = distance_between(here, node.pose) / drift();
    constexpr double kFarthest = 2.0;  // of what the robot may be off
    if (off > kFarthest) continue;
    candidates.push_back(
        {.node = match.number,
         .similarity = match.similarity,
         .activity = match.similarity * std::min(1.0, node.strength) * std::exp(-0.5 * off * off),
         .proven = {}});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.activity > b.activity; });
  constexpr int kNeighbourhood = 3;  // links
  std::vector<Candidate> apart;
  for (const Candidate& candidate : candidates) {
    if (static_cast<int>(apart.size()) >= settings_.candidates) break;
    if (std::none_of(apart.begin(), apart.end(), [&](const Candidate& other) {
          return map_.hops(other.node, candidate.node, kNeighbourhood) <= kNeighbourhood;
        }))
      apart.push_back(candidate);
  }
  return apart;
}

std::optional<ProvenPlace> Brain::prove(const Look& look, const std::vector<PlacePoint>& points) const {
  return prove_place(camera_, points, *look.features, scales_,
                     settings_.seed + static_cast<std::uint64_t>(look.frame), settings_.geometry,
                     settings_.mount);
}

// The candidate that one motion proves, unless another explains the image nearly as well.
std::optional<Brain::Candidate> Brain::prove(const Look& look, std::vector<Candidate> candidates) {
  const auto scope = timer_.measure("prove");
  std::optional<Candidate> best;
  int rival = 0;
  for (Candidate& candidate : candidates) {
    const std::optional<ProvenPlace> proven = prove(look, map_.node(candidate.node).points);
    if (!proven || proven->motion.distance() > settings_.farthest * keyframe_distance()) continue;
    candidate.proven = *proven;
    if (!best || proven->inliers > best->proven.inliers) {
      if (best) rival = std::max(rival, best->proven.inliers);
      best = candidate;
    } else {
      rival = std::max(rival, proven->inliers);
    }
  }
  if (!best) return std::nullopt;
  // Where the place says that the robot is, it must be able to be.
  const PlanePose there = map_.node(best->node).pose * best->proven.motion;
  if (distance_between(there, believed(look.since_anchor)) > 2.0 * drift()) return std::nullopt;
  if (rival > settings_.most_rival_share * best->proven.inliers) return std::nullopt;
  return best;
}

// Whether the image proves as well that the robot is at one of the last places, which it has left.
bool Brain::repeats_itself(const Look& look) {
  constexpr std::size_t kMostTried = 3;
  const auto scope = timer_.measure("repeats");
  const PlanePose here = believed(look.since_anchor);
  const double apart = 1.5 * keyframe_distance();
  std::vector<std::pair<double, int>> alike;  // similarity, node
  for (int i = left_nodes(); i < map_.size(); ++i) {
    if (distance_between(map_.node(i).pose, here) > apart)
      alike.emplace_back(memory_.likeness(i, look.view), i);
  }
  std::sort(alike.begin(), alike.end(), std::greater<>());
  for (std::size_t n = 0; n < std::min(alike.size(), kMostTried); ++n) {
    const Node& node = map_.node(alike[n].second);
    const std::optional<ProvenPlace> proven = prove(look, node.points);
    if (proven && distance_between(node.pose * proven->motion, here) > apart) return true;
  }
  return false;
}

bool Brain::agrees_with_the_last(const std::optional<Candidate>& candidate) {
  if (!candidate) {
    last_candidate_ = -1;
    in_a_row_ = 0;
    return false;
  }
  constexpr int kNear = 4;  // links
  const bool is_near = last_candidate_ >= 0 && map_.hops(last_candidate_, candidate->node, kNear) <= kNear;
  in_a_row_ = is_near ? in_a_row_ + 1 : 1;
  last_candidate_ = candidate->node;
  return in_a_row_ >= settings_.agreeing_in_a_row;
}

std::optional<Brain::Candidate> Brain::recognise(const Look& look, BrainResult& result) {
  if (std::optional<Candidate> here = nearby(look)) {
    agrees_with_the_last(here);
    unconfirmed_.reset();
    return here;
  }
  std::vector<Candidate> candidates = familiar(look, result);
  std::optional<Candidate> best;
  if (settings_.proof == PlaceProof::geometry) {
    best = prove(look, std::move(candidates));
    if (best && repeats_itself(look)) best.reset();
  } else if (!candidates.empty()) {
    best = candidates.front();
    best->proven.motion = {
        0.0, 0.0,
        memory_.turn_against(best->node, look.view, 2.0 * std::atan(0.5 * camera_.width / camera_.fx))};
  }
  const std::optional<Recall> before = std::exchange(unconfirmed_, std::nullopt);
  if (!agrees_with_the_last(best)) {
    if (best) unconfirmed_ = recall_of(look, *best);
    return std::nullopt;
  }
  result.confirmed = before;
  return best;
}

Recall Brain::recall_of(const Look& look, const Candidate& candidate) const {
  const Node& node = map_.node(candidate.node);
  return {.node = candidate.node,
          .loaded = candidate.node < loaded_nodes_,
          .frame = look.frame,
          .earlier_frame = node.frame,
          .similarity = candidate.similarity,
          .inliers = candidate.proven.inliers,
          .correction = distance_between(believed(look.since_anchor), node.pose * candidate.proven.motion)};
}

// The place cells are pulled to where the template was seen.
void Brain::recall(const Look& look, const Candidate& candidate, BrainResult& result) {
  Node& node = map_.node(candidate.node);
  result.recall = recall_of(look, candidate);
  node.strength += settings_.phi * candidate.similarity;
  if (!located_ && candidate.node < loaded_nodes_)
    join_loaded_map(believed(look.since_anchor), node.pose * candidate.proven.motion);
  if (anchor_ != candidate.node && !is_linked(anchor_, candidate.node)) {
    const bool is_proven = candidate.proven.inliers > 0;
    const double way = look.since_anchor.distance(), turn = std::abs(look.since_anchor.heading);
    const double of_place = is_proven ? settings_.proven_sigma : settings_.familiar_sigma;
    const double of_turn = is_proven ? settings_.proven_turn_sigma : settings_.familiar_turn_sigma;
    map_.add(Link{.from = anchor_,
                  .to = candidate.node,
                  .motion = look.since_anchor * candidate.proven.motion.inverse(),
                  .recalled = true,
                  .metres = std::hypot(of_place, settings_.way_sigma * way),
                  .radians = std::hypot(of_turn, settings_.turn_sigma * turn)});
    result.map_moved = settle();
  }
  anchor_ = candidate.node;
  since_anchor_ = candidate.proven.motion * (look.since_anchor.inverse() * since_anchor_);
  pull_position();
  way_at_fix_ = way_;
  doubt_ = 0.0;
  on_known_ground_ = true;
}

}  // namespace penumbra::slam::brain
