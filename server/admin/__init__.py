"""`integument admin`: what only whoever runs the server may do. It talks to the database the settings name, not over HTTP."""
