//! The library's interface to the page. Requests and answers are bytes in an `envelope`. `library.js` is the other side.
//!
//! The page writes a request to the address that [`make_room`] returns, calls [`answer`], and reads [`answer_length`] bytes. This
//! module owns the buffers, so it never has to trust a pointer from the page.

mod dropped;
mod envelope;
mod form;
mod page;
mod request;
mod session;
mod words;

use crate::session::Session;
use std::cell::RefCell;

thread_local! {
    static REQUEST: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static ANSWER: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static SESSION: RefCell<Session> = RefCell::default();
}

// SAFETY of the attributes below: no other linked code exports functions with these names.

/// Returns the address for a request of `length` bytes.
#[unsafe(no_mangle)]
pub extern "C" fn make_room(length: usize) -> *mut u8 {
    page::tell_panics();
    REQUEST.with_borrow_mut(|request| {
        *request = vec![0; length];
        request.as_mut_ptr()
    })
}

/// Executes the request, and returns the address of the answer.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    let answer = SESSION.with_borrow_mut(|session| request::answer(session, &REQUEST.take()));
    ANSWER.with_borrow_mut(|last| {
        *last = answer;
        last.as_ptr()
    })
}

/// Returns the length of the answer in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn answer_length() -> usize {
    ANSWER.with_borrow(Vec::len)
}
