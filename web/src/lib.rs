//! The library for a page: requests and answers are bytes, each an `envelope`. `library.js` is the other side.
//!
//! The page writes a request where [`make_room`] says, calls [`answer`] and reads as many bytes as [`answer_length`] says. The
//! buffers stay in this module, so that no pointer comes back to be trusted.

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

// SAFETY of the attributes below: no other code that is linked here exports functions by these names.

/// Where a request of so many bytes is to be written.
#[unsafe(no_mangle)]
pub extern "C" fn make_room(length: usize) -> *mut u8 {
    page::tell_panics();
    REQUEST.with_borrow_mut(|request| {
        *request = vec![0; length];
        request.as_mut_ptr()
    })
}

/// Does what the request says; where the answer begins.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    let answer = SESSION.with_borrow_mut(|session| request::answer(session, &REQUEST.take()));
    ANSWER.with_borrow_mut(|last| {
        *last = answer;
        last.as_ptr()
    })
}

/// How long the answer is.
#[unsafe(no_mangle)]
pub extern "C" fn answer_length() -> usize {
    ANSWER.with_borrow(Vec::len)
}
