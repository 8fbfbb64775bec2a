//
//   Formwork: smooth differential forms on OpenSubdiv surfaces.
//   MIT or Apache-2.0, see LICENSE-MIT and LICENSE-APACHE.
//

#ifndef FORMWORK_ERROR_H
#define FORMWORK_ERROR_H

#include <stdexcept>
#include <string>

#include "formwork.h"

namespace formwork {

/// \brief What every function of this library throws
///
/// The message is one line that names the element at fault and says what to do.
///
class Error : public std::runtime_error {
public:
    Error(FormworkStatus status, std::string const &message)
        : std::runtime_error("formwork: " + message), _status(status) {}

    /// \brief Whether the arguments are at fault, or Formwork itself (please report that)
    FormworkStatus GetStatus() const { return _status; }

private:
    FormworkStatus _status;
};

namespace internal {

// Turns the status of a call of the C ABI into an exception.
inline void
Check(FormworkStatus status) {
    if (status != FORMWORK_STATUS_OK) {
        throw Error(status, formwork_last_error());
    }
}

} // end namespace internal

} // end namespace formwork

#endif // FORMWORK_ERROR_H
