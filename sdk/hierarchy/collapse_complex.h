#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace armature::sdk {

inline constexpr std::uint32_t kNoIndex = std::numeric_limits<std::uint32_t>::max();

/// A complex of triangles and edges, manifold or not, whose edges are collapsed one after another. Nothing is created:
/// every level's simplices are images of the input's. A vertex lives in a slot, which at first is its own index; the
/// vertex that a collapse makes takes over the slot of one of the two.
///
/// Beside edges of the complex there are links: pairs that may be collapsed although nothing joins them. They are no
/// part of the shape.
class CollapseComplex {
 public:
  using Triangle = std::array<std::uint32_t, 3>;
  using Pair = std::array<std::uint32_t, 2>;

  /// The beginning or the end of a wire edge (an edge on no triangle). Level k is what k collapses leave.
  struct WireEvent {
    std::uint32_t level;  ///< the first that has it, or no longer has it
    std::uint32_t edge;
    std::uint32_t a, b;  ///< an input vertex in the region of either end; kNoIndex where the wire edge ends
  };

  /// What a collapse needs to tell the queue.
  struct Merged {
    std::uint32_t slot;                    ///< of the new vertex
    std::uint32_t gone;                    ///< the slot that is free now
    std::span<const std::uint32_t> edges;  ///< those of the new vertex; valid until the next collapse
  };

  /// Why there can be no complex of so many, or nothing: 32 bits count the ends of its edges.
  [[nodiscard]] static std::string refuses(std::size_t vertices, std::size_t triangles);

  /// Triangles that repeat a corner count as the edge that is left of them; of triangles with the same corners one is
  /// kept. Corners and pairs are below `vertices`.
  CollapseComplex(std::uint32_t vertices, std::span<const Triangle> triangles, std::span<const Pair> links);

  /// Of slots, in use or not.
  [[nodiscard]] std::uint32_t slot_count() const noexcept { return static_cast<std::uint32_t>(edge_to_.size()); }
  [[nodiscard]] std::uint32_t edge_count() const noexcept { return static_cast<std::uint32_t>(edges_.size()); }
  [[nodiscard]] const Pair& edge(std::uint32_t id) const noexcept { return edges_[id].ends; }
  /// What ranks the collapse of an edge, and what the queue notes of it; both 0 at first. They are kept here, in the
  /// line of the cache that every look at an edge loads.
  [[nodiscard]] std::uint32_t& key(std::uint32_t edge) noexcept { return edges_[edge].key; }
  [[nodiscard]] std::uint32_t key(std::uint32_t edge) const noexcept { return edges_[edge].key; }
  [[nodiscard]] std::uint8_t& note(std::uint32_t edge) noexcept { return edges_[edge].note; }
  [[nodiscard]] bool alive(std::uint32_t edge) const noexcept { return (edges_[edge].flags & Dead) == 0; }
  [[nodiscard]] bool is_link(std::uint32_t edge) const noexcept { return (edges_[edge].flags & Link) != 0; }
  [[nodiscard]] const Triangle& triangle(std::uint32_t id) const noexcept { return triangles_[id]; }
  [[nodiscard]] std::span<const std::uint32_t> edges_of(std::uint32_t slot) const noexcept {
    return edge_stars_.of(slot);
  }
  [[nodiscard]] std::span<const std::uint32_t> triangles_of(std::uint32_t slot) const noexcept {
    return triangle_stars_.of(slot);
  }

  /// Whether collapsing the edge keeps the complex's topology (the link condition of Dey, Edelsbrunner, Guha and
  /// Nekhayev 1999 for a 2-complex).
  [[nodiscard]] bool keeps_topology(std::uint32_t edge);

  /// Collapses an edge. Of two edges that become one, the one with the greater key lives on.
  Merged collapse(std::uint32_t edge);
  /// Collapses so far.
  [[nodiscard]] std::uint32_t steps() const noexcept { return steps_; }

  /// Whether an edge or a link joins two slots.
  [[nodiscard]] bool joined(std::uint32_t a, std::uint32_t b) const noexcept;
  /// Adds links between slots in use; returns the id of the first, the others follow. Pairs that are joined already,
  /// or repeated, are the caller's mistake.
  std::uint32_t add_links(std::span<const Pair> links);

  /// For each input triangle the first level at which it is no longer a triangle of its own: kNoIndex if it still is,
  /// kNever if it never was one.
  static constexpr std::uint32_t kNever = kNoIndex - 1;
  [[nodiscard]] std::vector<std::uint32_t> take_deaths() noexcept { return std::move(deaths_); }
  [[nodiscard]] std::vector<WireEvent> take_wire_events() noexcept { return std::move(wire_events_); }

 private:
  enum Flag : std::uint8_t { Dead = 1, Link = 2, Wire = 4 };
  struct Edge {
    Pair ends;
    std::uint32_t key = 0;
    std::uint8_t note = 0;
    std::uint8_t flags = 0;
  };
  static_assert(sizeof(Edge) == 16);

  /// Lists of varying length, one a slot, in one array.
  class Stars {
   public:
    void allot(std::span<const std::uint32_t> sizes);
    void push(std::uint32_t slot, std::uint32_t item) noexcept {
      items_[lists_[slot].begin + lists_[slot].size++] = item;
    }
    [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t slot) const noexcept {
      return {items_.data() + lists_[slot].begin, lists_[slot].size};
    }
    void remove(std::uint32_t slot, std::uint32_t item) noexcept;
    /// Gives `kept` the list and frees the one of `gone`; one of their places is used again if it is large enough.
    void merge(std::uint32_t kept, std::uint32_t gone, std::span<const std::uint32_t> list);

   private:
    /// Room for new lists is a fourth of what is used at first; when it is gone, what was freed is gathered.
    static constexpr std::uint32_t kSlack = 4;
    void pack(std::uint32_t more);

    struct List {
      std::uint32_t begin, size;
    };
    std::vector<std::uint32_t> items_;
    std::vector<List> lists_;  // by slot
    std::size_t slack_ = 0;
  };

  [[nodiscard]] std::uint32_t other_end(std::uint32_t edge, std::uint32_t slot) const noexcept {
    return edges_[edge].ends[0] ^ edges_[edge].ends[1] ^ slot;
  }
  [[nodiscard]] bool has_corner(std::uint32_t triangle, std::uint32_t slot) const noexcept {
    const Triangle& t = triangles_[triangle];
    return t[0] == slot || t[1] == slot || t[2] == slot;
  }
  [[nodiscard]] std::size_t triangles_on(std::uint32_t a, std::uint32_t b) const noexcept;
  void merge_triangles(std::uint32_t kept, std::uint32_t gone);
  void merge_edges(std::uint32_t collapsed, std::uint32_t kept, std::uint32_t gone);
  void settle_wires(std::uint32_t kept);
  void end_wire(std::uint32_t edge);

  std::vector<Triangle> triangles_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> deaths_;
  std::vector<WireEvent> wire_events_;
  Stars triangle_stars_, edge_stars_;
  std::uint32_t steps_ = 0;

  // What a collapse works with; empty or kNoIndex between collapses.
  std::vector<std::uint32_t> edge_to_;  // by slot: the kept vertex's edge to it
  std::vector<std::uint32_t> star_;
  std::vector<std::uint32_t> doubled_;  // edges that two became
};

}  // namespace armature::sdk
