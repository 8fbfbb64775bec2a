//
//   Formwork: smooth differential forms on OpenSubdiv surfaces.
//   MIT or Apache-2.0, see LICENSE-MIT and LICENSE-APACHE.
//

#ifndef FORMWORK_FORM_REFINER_H
#define FORMWORK_FORM_REFINER_H

#include <memory>
#include <vector>

#include <opensubdiv/far/topologyRefiner.h>
#include <opensubdiv/version.h>

#include "error.h"

namespace formwork {

/// \brief What forms do where OpenSubdiv leaves a choice
///
/// The scheme itself is the refiner's: Catmull-Clark, Loop or bilinear, with all its options.
///
struct SchemeOptions {

    /// \brief Weights of faces round an irregular vertex of Catmull-Clark
    enum DooSabin {
        DOO_SABIN_THESIS = FORMWORK_DOO_SABIN_THESIS,    ///< Catmull and Clark's, as in Wang's thesis
        DOO_SABIN_ORIGINAL = FORMWORK_DOO_SABIN_ORIGINAL ///< Doo and Sabin's own
    };

    /// \brief Weights of faces at the boundaries and creases of Loop
    enum HalfBox {
        HALF_BOX_REFLECT = FORMWORK_HALF_BOX_REFLECT, ///< faces are reflected evenly
        HALF_BOX_THESIS = FORMWORK_HALF_BOX_THESIS,   ///< Appendix B of Wang's thesis
        HALF_BOX_DCT = FORMWORK_HALF_BOX_DCT          ///< a cosine transform
    };

    SchemeOptions() : dooSabin(DOO_SABIN_THESIS), halfBox(HALF_BOX_REFLECT) {}

    DooSabin dooSabin; ///< used by Sdc::SCHEME_CATMARK
    HalfBox halfBox;   ///< used by Sdc::SCHEME_LOOP
};

/// \brief Refines forms on the levels of a Far::TopologyRefiner
///
/// A form of degree 0 has a value for each vertex of a level, one of degree 1 a value for each edge, in the
/// direction of TopologyLevel::GetEdgeVertices(), and one of degree 2 a value for each face. All indices are those of
/// the refiner. Refinement commutes with the exterior derivative, and forms of degree 0 are refined as OpenSubdiv
/// refines primvars.
///
/// All that is needed of the refiner is read when the object is made; the refiner may go afterwards. The object does
/// not change: threads may share it.
///
class FormRefiner {
public:

    /// \brief Reads all levels of a refiner
    ///
    /// @param refiner  Refined by RefineUniform() without orderVerticesFromFacesFirst, or
    ///                 not refined at all. Its last level need not have full topology.
    ///                 Adaptive refinement is out of scope.
    ///
    /// @param options  What OpenSubdiv leaves open
    ///
    /// Throws Error if the refiner is another one, or its mesh has faces of fewer than three vertices or faces
    /// that meet a vertex twice.
    ///
    explicit FormRefiner(OpenSubdiv::Far::TopologyRefiner const &refiner,
                         SchemeOptions options = SchemeOptions()) {
        FormworkOptions chosen = {static_cast<uint32_t>(options.dooSabin), static_cast<uint32_t>(options.halfBox)};
        FormworkHierarchy *hierarchy = nullptr;
        internal::Check(formwork_hierarchy_from_refiner(&refiner, OPENSUBDIV_VERSION_NUMBER, &chosen, &hierarchy));
        _hierarchy.reset(hierarchy);
    }

    /// \brief Returns the number of the finest level
    int GetMaxLevel() const {
        int32_t level = 0;
        internal::Check(formwork_hierarchy_finest_level(_hierarchy.get(), &level));
        return level;
    }

    /// \brief Returns how many values a form has on a level: its vertices, edges or faces
    ///
    /// @param degree  0, 1 or 2
    ///
    /// @param level   0 to GetMaxLevel()
    ///
    int GetNumValues(int degree, int level) const {
        FormworkCounts counts;
        internal::Check(formwork_hierarchy_counts(_hierarchy.get(), level, &counts));
        switch (degree) {
        case 0: return static_cast<int>(counts.vertices);
        case 1: return static_cast<int>(counts.edges);
        case 2: return static_cast<int>(counts.faces);
        default: throw Error(FORMWORK_STATUS_INVALID_ARGUMENT, "a form has degree 0, 1 or 2");
        }
    }

    /// \brief Returns +1 for each edge of each face that runs with its face, and -1 for each that runs against it
    ///
    /// Face after face, in the order of TopologyLevel::GetFaceEdges(). The exterior derivative of a form of degree 1 is
    /// the sum of sign * value over the edges of a face.
    ///
    std::vector<signed char> GetFaceEdgeSigns(int level) const {
        FormworkCounts counts;
        internal::Check(formwork_hierarchy_counts(_hierarchy.get(), level, &counts));
        std::vector<signed char> signs(counts.corners);
        internal::Check(formwork_hierarchy_topology(_hierarchy.get(), level, nullptr, nullptr,
                                                    nullptr, nullptr, signs.data()));
        return signs;
    }

    /// \brief Returns the handle of the C ABI, which this object owns
    FormworkHierarchy const *GetHandle() const { return _hierarchy.get(); }

private:
    struct Free {
        void operator()(FormworkHierarchy *hierarchy) const { formwork_hierarchy_free(hierarchy); }
    };

    std::unique_ptr<FormworkHierarchy, Free> _hierarchy;
};

} // end namespace formwork

#endif // FORMWORK_FORM_REFINER_H
